"""What a laboratory has and the model has not: the catalogue of effects."""
