// SPDX-License-Identifier: Apache-2.0
#include <rths/monitor/look.hpp>

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rths::monitor {
namespace {

using Json = nlohmann::ordered_json;

const char* to_text(broker::Presence::State state) {
  switch (state) {
    case broker::Presence::State::Alive:
      return "alive";
    case broker::Presence::State::Vanished:
      return "vanished";
    case broker::Presence::State::Absent:
      break;
  }
  return "absent";
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json json_of(const NodeState& node) {
  return {{"node", node.name},
          {"state", to_text(node.presence.state)},
          {"pid", node.presence.pid},
          {"plain", node.is_plain},
          {"rate_hz", node.rate},
          {"writes_per_s", node.writes},
          {"age_s", json_of(node.age)},
          {"lost", node.lost},
          {"steps", json_of(node.steps)},
          {"late_s", json_of(node.late)},
          {"late_max_s", json_of(node.late_max)},
          {"duration_s", json_of(node.duration)},
          {"overruns", json_of(node.overruns)},
          {"stale_reads", json_of(node.stale)}};
}

std::string in_ms(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.3f}", 1e3 * *seconds) : "-";
}

std::string counted(const std::optional<double>& count) {
  return count ? fmt::format("{:.0f}", *count) : "-";
}

std::string line_of(const NodeState& node) {
  const std::string age = node.age ? fmt::format("{:.1f}", 1e3 * *node.age) : "-";
  return fmt::format("{:<14} {:<9} {:>9.1f} {:>10.0f} {:>9} {:>9} {:>9} {:>9} {:>8} {:>7} {:>6}\n",
                     node.name, node.is_plain ? "plain" : to_text(node.presence.state), node.rate,
                     node.writes, age, in_ms(node.late), in_ms(node.late_max), in_ms(node.duration),
                     counted(node.overruns), counted(node.stale), node.lost);
}

}  // namespace

std::string json_of(const RingLook& look) {
  Json json = {{"ring", look.ring()},
               {"map", look.map().description().name},
               {"watched_s", to_seconds(look.updated() - look.begun())},
               {"nodes", Json::array()},
               {"safety", Json::array()},
               {"violations", Json::array()},
               {"events", Json::array()}};
  for (const auto& node : look.nodes()) json["nodes"].push_back(json_of(node));
  for (const auto& layer : look.safety())
    json["safety"].push_back({{"node", layer.node}, {"state", layer.state}, {"trip", layer.trip}});
  for (const auto& [name, found] : look.violations())
    json["violations"].push_back({{"word", found.word},
                                  {"value", found.value},
                                  {"owner", found.owner},
                                  {"writers", found.writers},
                                  {"count", found.count},
                                  {"time_s", found.time}});
  for (const auto& event : look.events())
    json["events"].push_back({{"number", event.number},
                              {"time_s", event.time},
                              {"text", event.text},
                              {"bad", event.is_bad}});
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string text_of(const RingLook& look) {
  constexpr std::size_t kMostEventLines = 8;
  std::string text =
      fmt::format("ring {}, map {}, watched for {:.1f} s\n\n", look.ring(),
                  look.map().description().name, to_seconds(look.updated() - look.begun()));
  text += fmt::format("{:<14} {:<9} {:>9} {:>10} {:>9} {:>9} {:>9} {:>9} {:>8} {:>7} {:>6}\n",
                      "node", "state", "rate/Hz", "writes/s", "age/ms", "late/ms", "most/ms",
                      "step/ms", "overruns", "stale", "lost");
  for (const auto& node : look.nodes())
    if (node.presence.state != broker::Presence::State::Absent || node.age) text += line_of(node);
  for (const auto& layer : look.safety())
    text += fmt::format("\nsafety layer of {}: {}{}{}", layer.node, layer.state,
                        layer.trip.empty() ? "" : "; tripped: ", layer.trip);
  if (!look.safety().empty()) text += "\n";
  for (const auto& [name, found] : look.violations())
    text += fmt::format("{} = {} of {}, stored {} times by {}\n", found.word, found.value,
                        found.owner, found.count, found.writers);
  const auto& events = look.events();
  const std::size_t shown = std::min(events.size(), kMostEventLines);
  if (shown > 0) text += "\n";
  for (auto event = events.end() - static_cast<std::ptrdiff_t>(shown); event != events.end();
       ++event)
    text += fmt::format("{:10.3f} s  {}\n", event->time, event->text);
  return text;
}

}  // namespace rths::monitor
