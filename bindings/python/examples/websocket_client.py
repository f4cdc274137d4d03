"""Follows a gi-server over WebSockets and TLS, and says what arrives.

    websocket_client.py wss://HOST:PORT [--token-file FILE] [--ca FILE] [--updates N] [--save FILE.npz]

`gi-server --listen-web` is the other end. Messages go through gicodec.Client; the transport is the
websockets package, and could be anything else that delivers whole messages.
"""

import argparse
import asyncio
import pathlib
import ssl

import numpy as np
import websockets

import gicodec


async def follow(url, client, context, updates):
    async with websockets.connect(url, subprotocols=["gicodec"], ssl=context, compression=None,
                                  max_size=1 << 28) as socket:
        await socket.send(client.hello())
        seen, chosen = 0, set()
        async for message in socket:
            # Decoding may take milliseconds; it lets other tasks run meanwhile.
            going_on = await asyncio.to_thread(client.receive, message)
            for volume in client.volumes:
                if volume.instance not in chosen:  # without a camera or a choice nothing is sent
                    chosen.add(volume.instance)
                    blocks = next(iter(volume.textures.values())).block_count
                    client.subscribe(volume.number, np.ones(blocks))
            for answer in client.messages():
                await socket.send(answer)
            state = client.state
            if not going_on:
                raise SystemExit(f"the server ended the session: {state['reason']}")
            if state["serial"] == seen or not state["consistent"]:
                continue
            for volume in client.volumes:
                for name in volume.textures:
                    blocks = volume.changed(name, after=seen).size
                    print(f"update {state['update']}: {volume.name}/{name}, {blocks} blocks")
            seen = state["serial"]
            if updates and seen >= updates:
                break
        client.disconnect()
        for answer in client.messages():
            await socket.send(answer)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("url")
    parser.add_argument("--token-file", type=pathlib.Path)
    parser.add_argument("--ca", help="certificate of the authority that signed the server's")
    parser.add_argument("--updates", type=int, default=0, help="end after so many; 0: never")
    parser.add_argument("--save", help="write the last textures to this .npz file")
    options = parser.parse_args()
    token = options.token_file.read_text().splitlines()[0] if options.token_file else ""
    context = None
    if options.url.startswith("wss:"):
        context = ssl.create_default_context(cafile=options.ca)
        context.minimum_version = ssl.TLSVersion.TLSv1_3
    client = gicodec.Client(token=token)
    asyncio.run(follow(options.url, client, context, options.updates))
    if options.save:
        np.savez(options.save, **{f"{volume.name}/{name}": volume.read(name)
                                  for volume in client.volumes for name in volume.textures})


if __name__ == "__main__":
    main()
