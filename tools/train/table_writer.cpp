#include "train/table_writer.h"

#include <fmt/core.h>

#include <span>

namespace gicodec::train {
namespace {

class Writer {
 public:
  void number(unsigned value) {
    const std::string item = fmt::format("{},", value);
    if (column_ + item.size() > 100) end_line();
    text_ += item;
    column_ += item.size();
  }
  void end_line() {
    text_ += '\n';
    column_ = 0;
  }
  std::string finish() { return std::move(text_); }

 private:
  std::string text_;
  std::size_t column_ = 0;
};

void write(const native::Distribution& m, Writer& w) {
  w.number(m.unit);
  w.number(m.shift);
  for (const auto units : m.units) w.number(units);
  w.end_line();
}
void write(const RepeatEnds& m, Writer& w) {
  w.number(m.end0);
  w.number(m.end1);
  w.end_line();
}
template <typename Distribution>
void write(const DistributionTables<Distribution>& family, unsigned contexts, Writer& w) {
  for (const auto& m : family.distribution) write(m, w);
  for (const auto m : std::span(family.map).first(contexts)) w.number(m);
  w.end_line();
}

}  // namespace

std::string to_text(const Model& model) {
  Writer w;
  for (const auto& role : model.role) {
    for (const auto& family : role) write(family, native::kContexts, w);
  }
  for (const auto& kind : model.repeats) {
    for (const auto& family : kind) write(family, native::kRepeatContexts, w);
  }
  return w.finish();
}

}  // namespace gicodec::train
