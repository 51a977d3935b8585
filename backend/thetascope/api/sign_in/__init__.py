"""The middleware that admits requests, the sign-in page, and the open websockets of each client."""
