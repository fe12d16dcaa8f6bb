"""What even a controller that knows everything but the future would miss."""
