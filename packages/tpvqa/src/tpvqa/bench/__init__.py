"""Many episodes → tables and figures."""
