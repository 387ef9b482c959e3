// SPDX-License-Identifier: Apache-2.0
//
// Chrome trace events: a thread per node with the messages on its output, arrows from hop to hop.
#include <iterator>

#include <fmt/format.h>

#include <rths/replicated/scenario.hpp>

namespace rths::replicated {
namespace {

// In the order of Hop::Kind.
constexpr const char* kKindNames[] = {"inserted", "repeated", "passed",  "stored",
                                      "rejected", "removed",  "expired", "lost at an open ring"};

const char* name_of(Hop::Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

bool is_slice(const Hop& hop) {
  return hop.kind == Hop::Kind::Inserted || hop.kind == Hop::Kind::Repeated ||
         hop.kind == Hop::Kind::Passed;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) >= 0x20) out += c;
  }
  return out;
}

/// Writes events, one per line; times in µs.
class TraceWriter {
 public:
  explicit TraceWriter(const Scenario& scenario) {
    for (const auto& name : scenario.names) names_.push_back(escaped(name));
    put(R"~("ph":"M","pid":1,"name":"process_name","args":{{"name":"ring, seed {}"}})~",
        scenario.setup.seed);
    for (std::size_t node = 0; node < names_.size(); ++node)
      put(R"~("ph":"M","pid":1,"tid":{},"name":"thread_name","args":{{"name":"{} (id {})"}})~",
          node, names_[node], scenario.setup.nodes[node].id);
  }

  void add(const Hop& hop) {
    const std::string title = fmt::format("{} #{}", names_[hop.origin], hop.message);
    const std::string arguments = fmt::format(
        R"~("args":{{"event":"{}","message":{},"byte_offset":{},"longwords":{},"age":{}}})~",
        name_of(hop.kind), hop.message, hop.address.value(), hop.longwords, hop.age);
    const double begin = to_ns(hop.begin) * 1e-3;
    if (!is_slice(hop)) {
      put(R"~("ph":"i","s":"t","pid":1,"tid":{},"ts":{:.6f},"name":"{} {}",{})~", hop.node, begin,
          name_of(hop.kind), title, arguments);
      return;
    }
    put(R"~("ph":"X","pid":1,"tid":{},"ts":{:.6f},"dur":{:.6f},"name":"{}",{})~", hop.node, begin,
        to_ns(hop.end - hop.begin) * 1e-3, title, arguments);
    put(R"~("ph":"{}","pid":1,"tid":{},"ts":{:.6f},"id":{},"name":"way","cat":"way")~",
        hop.kind == Hop::Kind::Passed ? "t" : "s", hop.node, begin, hop.message);
  }

  void level(std::uint32_t node, Time time, std::uint32_t entries) {
    put(R"~("ph":"C","pid":1,"ts":{:.6f},"name":"transmit FIFO of {}","args":{{"entries":{}}})~",
        to_ns(time) * 1e-3, names_[node], entries);
  }

  std::string take() {
    return "{\"traceEvents\":[\n" + events_ + "\n],\"displayTimeUnit\":\"ns\"}\n";
  }

 private:
  template <class... Values>
  void put(fmt::format_string<Values...> format, Values&&... values) {
    events_ += events_.empty() ? "{" : ",\n{";
    fmt::format_to(std::back_inserter(events_), format, std::forward<Values>(values)...);
    events_ += '}';
  }

  std::vector<std::string> names_;  ///< escaped
  std::string events_;
};

}  // namespace

std::string trace_of(const Scenario& scenario) {
  Course course{scenario};
  TraceWriter writer{scenario};
  course.ring().observe([&](const Hop& hop) {
    writer.add(hop);
    if (hop.kind == Hop::Kind::Inserted)
      writer.level(hop.node, hop.begin, course.ring().card(hop.node).report().transmit_fifo);
  });
  course.run_until(scenario.duration);
  return writer.take();
}

}  // namespace rths::replicated
