"""What each result says on its page, put together from `bench.report.page`."""
