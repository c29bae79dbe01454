"""Bodies of soil discs whose slides are known by theory or experiment: columns, cuts, uniform slopes."""
