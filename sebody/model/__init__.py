"""Models as users build them; nothing here is compiled."""
