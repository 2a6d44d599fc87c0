"""The service and the command line. They know no physics."""
