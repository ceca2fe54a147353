"""What a robot can do by itself: find, pick up and place, behind one small protocol."""
