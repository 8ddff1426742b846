"""The TypeScript target: a package of ES modules, one for each protocol, and their runtime."""
