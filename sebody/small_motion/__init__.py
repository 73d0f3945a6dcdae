"""Small motion about a state: linearization, vibrations, frequency responses, Campbell."""
