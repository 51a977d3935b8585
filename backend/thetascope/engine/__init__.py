"""The numerics. Nothing here knows pydantic, the web or asyncio."""
