"""What a user builds; nothing here is compiled."""
