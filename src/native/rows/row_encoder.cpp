#include "native/frame/workspace.h"
#include "native/rows/row_chunk.h"

#include "base/binary_coder.h"
#include "base/bytes.h"

#include <algorithm>

namespace gicodec::native {
namespace {

/// Steps of all strips, in order.
std::span<const Step> model(const Update& u, RowStrip& strip, RowMemory& memory) {
  const RowPlanes& planes = memory.planes;
  const std::size_t slice = planes.rows_of_slice(),
                    strips = planes.rows() / slice * ((slice + kLanes - 1) / kLanes);
  const std::size_t most = strips * row_steps(planes.columns()) * (1 + strip.channels);
  if (memory.steps.size() < most) {
    memory.steps = {};
    memory.steps.resize(most);
  }
  Step* next = memory.steps.data();
  for (std::size_t y = 0; y < planes.rows(); y += strip.rows) {
    move_to(u.kernels, strip, memory, y);
    load_lanes(u.kernels, memory, y);
    next = u.kernels.model_rows(strip, next);
  }
  return {memory.steps.data(), next};
}

}  // namespace

bool encode_rows(const Update& u, std::span<const std::uint32_t> positions,
                 const BlockTable& records, RowChoice choice, std::size_t most, RowMemory& memory,
                 ValueModel& values, std::vector<std::byte>& out) {
  RowPlanes& planes = memory.planes;
  planes.lay_out(u, positions, true);
  if (u.mirrored) planes.load_mirror(u);
  for (const auto position : positions) planes.load(u, u.probes[position], records[position]);
  planes.to_ordinals();
  if (!planes.choose_forms(choice, memory.forms)) return false;
  memory.forms_bytes.clear();
  values.reset();
  BinaryEncoder coder(memory.forms_bytes);
  if (!memory.forms.code(coder, planes.channels(), planes.texels(), values)) return false;
  coder.finish();
  if (!planes.list_coded(memory.forms)) return false;

  const std::size_t begin = out.size();
  ByteWriter writer(out);
  writer.fixed(kRowChunk);
  writer.varint(memory.forms_bytes.size());
  writer.bytes(memory.forms_bytes);
  if (!planes.coded().empty()) {
    planes.to_planes(memory.forms);
    if (u.update) load_past(u, positions, memory);
    RowStrip strip = prepare_strips(u.update, memory);
    const RowClasses classes = classes_of(strip);
    const auto steps = model(u, strip, memory);
    memory.tables.fit(steps, classes);
    memory.tables.write(classes, writer);
    memory.bytes.resize(most + kMaxStepBytes * (1 + strip.channels) + kSlack);
    Output output{};
    std::fill(std::begin(output.state), std::end(output.state), kStateLow);
    auto* const last = reinterpret_cast<std::uint8_t*>(memory.bytes.data() + memory.bytes.size());
    output.next = last;
    const auto written = [&] { return static_cast<std::size_t>(last - output.next); };
    for (std::size_t left = steps.size(); left > 0 && written() <= most;) {
      const std::size_t count = std::min<std::size_t>(left, 1 + strip.channels);
      left -= count;
      u.kernels.encode_steps(steps.data() + left, steps.data() + left + count,
                             memory.tables.tables(), output);
    }
    const std::size_t lanes = std::min<std::size_t>(kLanes, planes.rows_of_slice());
    for (std::size_t l = 0; l < lanes; ++l) writer.fixed(output.state[l]);
    writer.bytes(std::as_bytes(std::span(output.next, written())));
  }
  if (out.size() - begin <= most) return true;
  out.resize(begin);
  return false;
}

}  // namespace gicodec::native
