"""Where simulation and experiment differ, which effect causes it, and how far adding it closes the gap."""
