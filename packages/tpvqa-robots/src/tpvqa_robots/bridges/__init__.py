"""tpvqa inside programs of others: behaviour trees."""
