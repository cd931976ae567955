"""All joints of a robot together: from its logs to a model that moves like it."""
