"""The example of the TypeScript package: a page that speaks to a device by Web Serial."""
