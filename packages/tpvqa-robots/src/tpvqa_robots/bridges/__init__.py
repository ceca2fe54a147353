"""tpvqa inside programs of others: behaviour trees, environments of Gymnasium."""
