"""Plots a file: one probe over its frames, the whole volume over time, and bytes per frame.

    plot.py FILE.gic PICTURE.png [--texture color] [--probe N]
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import gicodec  # noqa: E402


def colours(desc, array):
    """Red, green and blue from 0 to 1, with a display's gamma."""
    return np.clip(desc.as_float(array)[..., :3], 0, 1) ** (1 / 2.2)


def bytes_of_frames(texture):
    """What each frame takes as a packet of its own."""
    encoder = gicodec.Encoder(texture.desc)
    return [len(encoder.encode(frame)) for frame in texture]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("picture")
    parser.add_argument("--texture", default="color")
    parser.add_argument("--probe", type=int, help="default: the one that changes most")
    options = parser.parse_args()

    with gicodec.open(options.file) as file:
        texture = file[options.texture]
        desc = texture.desc
        blocks = np.stack([desc.as_float(texture.blocks(i))[..., :3] for i in range(len(texture))])
        mean = blocks.mean(axis=(2, 3, 4))  # frame, probe, channel
        probe = options.probe
        if probe is None:
            probe = int(np.ptp(mean.sum(axis=2), axis=0).argmax())
        sizes = bytes_of_frames(texture)
        middle = blocks[len(texture) // 2, probe, 0]

    figure, ((image, bars), (day, size)) = plt.subplots(2, 2, figsize=(10, 6), layout="constrained")
    image.imshow(np.clip(middle, 0, 1) ** (1 / 2.2), interpolation="nearest")
    image.set_title(f"probe {probe}, frame {file.frames[len(file.frames) // 2]}")
    image.axis("off")
    for channel, colour in enumerate(("tab:red", "tab:green", "tab:blue")):
        bars.plot(file.frames, mean[:, probe, channel], color=colour)
    bars.set_title(f"probe {probe} over time")
    bars.set_xlabel("frame")
    bars.set_ylabel("mean irradiance")
    day.imshow(np.clip(mean / max(np.percentile(mean, 99), 1e-6), 0, 1).transpose(1, 0, 2) ** (1 / 2.2),
               aspect="auto", interpolation="nearest")
    day.set_title("all probes over time")
    day.set_xlabel("frame")
    day.set_ylabel("probe")
    size.bar(file.frames, np.array(sizes) / 1024, width=0.8 * min(np.diff(file.frames), default=1))
    size.set_title(f"packets, of {desc.nbytes / 1024:.0f} KiB of texels")
    size.set_xlabel("frame")
    size.set_ylabel("KiB")
    figure.savefig(options.picture, dpi=100)


if __name__ == "__main__":
    main()
