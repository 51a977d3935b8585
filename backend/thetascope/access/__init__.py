"""Who may use the service, and as whom: the access key, tickets of browsers that signed in, owners, limits of a client.

Nothing here knows HTTP; `thetascope.api.sign_in` asks it about each request.
"""
