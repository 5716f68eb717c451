"""What trainings of networks have in common."""
