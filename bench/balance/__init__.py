"""The one engine: a recording in rows through one filter, a hypothesis, its fit, the noise floor, the covariance."""
