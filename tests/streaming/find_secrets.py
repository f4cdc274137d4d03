#!/usr/bin/env python3
"""find_secrets.py CAPTURE SECRETS: how many of the secrets, a line of hexadecimal digits each, are
in the capture, as they are or under any mask of four bytes that repeats, as WebSockets put on."""
import sys


def unmasked(data):
    """What is left of bytes when any such mask is taken away."""
    return (int.from_bytes(data[:-4], "little") ^ int.from_bytes(data[4:], "little")).to_bytes(
        max(0, len(data) - 4), "little")


capture = unmasked(open(sys.argv[1], "rb").read())
secrets = [bytes.fromhex(line) for line in open(sys.argv[2])]
assert secrets and all(len(secret) >= 12 for secret in secrets)
print(sum(unmasked(secret) in capture for secret in secrets), "of", len(secrets))
