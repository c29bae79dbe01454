"""Many runs on whatever machines there are: tasks, the workers that compute them, the folder that keeps answers."""
