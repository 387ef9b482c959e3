// SPDX-License-Identifier: Apache-2.0
#include <rths/replicated/scenario.hpp>

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include <rths/replicated/images.hpp>

#include "node.hpp"

namespace rths::replicated {
namespace {

const std::map<std::string, std::uint32_t> kProtocols{
    // CSR2
    {"burst", 0xC040},    {"burst_256", 0xD040},    {"burst_1024", 0xD840},
    {"platinum", 0x4040}, {"platinum_256", 0x5040}, {"platinum_1024", 0x5840}};
const std::map<std::string, Action::Kind> kFaults{{"power_off", Action::Kind::PowerOff},
                                                  {"power_on", Action::Kind::PowerOn},
                                                  {"cut_fibre", Action::Kind::CutFibre},
                                                  {"repair_fibre", Action::Kind::RepairFibre},
                                                  {"bit_error_rate", Action::Kind::BitErrorRate},
                                                  {"delay", Action::Kind::Delay},
                                                  {"id", Action::Kind::Id}};

template <class Value>
Value choice(const Config& table, const std::string& key, const std::map<std::string, Value>& known,
             const std::string& otherwise) {
  const std::string name = otherwise.empty() ? table.text(key) : table.text(key, otherwise);
  if (const auto found = known.find(name); found != known.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [one, value] : known) names.push_back(one);
  table.fail(key, fmt::format("'{}'{}", name, did_you_mean_one_of(name, names)));
}

Time microseconds(const Config& table, const std::string& key, std::optional<double> otherwise) {
  return from_ns(1e3 * table.number_in(key, 0, 1e9, otherwise));
}

std::uint32_t whole(const Config& table, const std::string& key, std::int64_t most,
                    std::optional<std::int64_t> otherwise = std::nullopt) {
  return static_cast<std::uint32_t>(table.integer_in(key, 0, most, otherwise));
}

std::uint32_t node_of(const Config& table, const std::vector<std::string>& names) {
  const std::string name = table.text("node");
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    table.fail("node", fmt::format("'{}' is no node{}; the nodes are {}", name,
                                   did_you_mean(name, names), fmt::join(names, ", ")));
  return static_cast<std::uint32_t>(found - names.begin());
}

/// Reads the tables of a scenario.
class ScenarioReader {
 public:
  explicit ScenarioReader(const Config& file) {
    static_cast<void>(file.integer_in("format", 1, 1));
    scenario_.setup.cards =
        choice<CardType>(file, "cards", {{"plus", CardType::Plus}, {"gt", CardType::Gt}}, "plus");
    csr2_ = read_protocol(file);
    scenario_.setup.strict_ids = file.flag("strict_ids", false);
    scenario_.setup.bit_error_rate = file.number_in("bit_error_rate", 0, 1, 0);
    scenario_.setup.seed = static_cast<std::uint64_t>(file.integer_in("seed", 0, INT64_MAX, 1));
    scenario_.duration = microseconds(file, "duration_us", std::nullopt);
    for (const Config& node : file.tables("node")) read_node(node);
    if (scenario_.names.empty()) file.fail("node", "no node, expected [[node]] tables");
    for (const Config& write : file.tables("write")) read_write(write);
    for (const Config& traffic : file.tables("traffic")) read_traffic(traffic);
    for (const Config& fault : file.tables("fault")) read_fault(fault);
    file.reject_unknown_keys();
    std::stable_sort(scenario_.actions.begin(), scenario_.actions.end(),
                     [](const Action& a, const Action& b) { return a.at < b.at; });
  }
  Scenario take() { return std::move(scenario_); }

 private:
  [[nodiscard]] bool is_plus() const { return scenario_.setup.cards == CardType::Plus; }

  void read_node(const Config& table) {
    const std::string name = table.text("name");
    const std::uint32_t count = whole(table, "count", 256, 1);
    NodeSetup setup;
    setup.id = whole(table, "id", 255, static_cast<std::int64_t>(scenario_.names.size() + 1) % 256);
    setup.fibre_m = table.number_in("fibre_m", 0, 1e6, setup.fibre_m);
    setup.memory_bytes = whole(table, "memory_bytes", 512 << 20, is_plus() ? 2 << 20 : 128 << 20);
    setup.bypass_switch = table.flag("bypass_switch", true);
    setup.extra_delay = from_ns(table.number_in("extra_delay_ns", 0, 1e9, 0));
    const bool inserted = table.flag("inserted", true);
    const auto csr = table.has("csr") ? table.rows("csr") : std::vector<std::vector<double>>{};
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto node = static_cast<std::uint32_t>(scenario_.names.size());
      scenario_.names.push_back(count == 1 ? name : fmt::format("{}{}", name, i + 1));
      scenario_.setup.nodes.push_back(setup);
      setup.id = (setup.id + 1) % 256;
      if (is_plus()) add_csr(node, 2, csr2_);
      if (is_plus() && inserted) add_csr(node, 0, kOnRing);
      for (const auto& row : csr) add_csr(table, row, node);
    }
    table.reject_unknown_keys();
  }

  void add_csr(const Config& table, const std::vector<double>& row, std::uint32_t node) {
    if (row.size() != 2 || !is_plus()) table.fail("csr", "expected [[register, value], …]");
    add_csr(node, static_cast<std::uint32_t>(row[0]), static_cast<std::uint32_t>(row[1]));
  }

  void add_csr(std::uint32_t node, std::uint32_t index, std::uint32_t value) {
    scenario_.actions.push_back(
        {.kind = Action::Kind::Csr, .node = node, .index = index, .value = value});
  }

  [[nodiscard]] std::uint32_t node_of(const Config& table) const {
    return replicated::node_of(table, scenario_.names);
  }

  // A store, a register, or an interrupt of a GT card.
  void read_write(const Config& table) {
    Action action;
    action.at = microseconds(table, "at_us", std::nullopt);
    action.node = node_of(table);
    action.value = whole(table, "value", 0xFFFF'FFFF);
    if (table.has("csr") && is_plus()) {
      action.kind = Action::Kind::Csr;
      action.index = whole(table, "csr", 15);
    } else if (table.has("interrupt") && !is_plus()) {
      action.kind = Action::Kind::Interrupt;
      action.index = whole(table, "interrupt", 31);
    } else {
      action.index = longword_of(table, action.node);
    }
    table.reject_unknown_keys();
    scenario_.actions.push_back(action);
  }

  [[nodiscard]] std::uint32_t longword_of(const Config& table, std::uint32_t node) const {
    const std::uint64_t words = scenario_.setup.nodes[node].memory_bytes / 4;
    return whole(table, "longword", static_cast<std::int64_t>(words) - 1);
  }

  void read_traffic(const Config& table) {
    Traffic traffic;
    traffic.node = node_of(table);
    traffic.from = microseconds(table, "from_us", 0);
    traffic.until = microseconds(table, "until_us", to_ns(scenario_.duration) * 1e-3);
    traffic.period = from_ns(table.number_in("period_ns", 1, 1e12));
    traffic.longword = longword_of(table, traffic.node);
    const auto words =
        static_cast<std::int64_t>(scenario_.setup.nodes[traffic.node].memory_bytes / 4);
    traffic.longwords =
        static_cast<std::uint32_t>(table.integer_in("longwords", 1, words - traffic.longword, 1));
    traffic.random =
        choice<bool>(table, "order", {{"ascending", false}, {"random", true}}, "ascending");
    table.reject_unknown_keys();
    scenario_.traffic.push_back(traffic);
  }

  void read_fault(const Config& table) {
    Action action = replicated::read_fault(table, scenario_.names);
    action.at = microseconds(table, "at_us", std::nullopt);
    table.reject_unknown_keys();
    scenario_.actions.push_back(action);
  }

  Scenario scenario_;
  std::uint32_t csr2_ = 0;
};

}  // namespace

Action read_fault(const Config& table, const std::vector<std::string>& names) {
  Action action;
  action.kind = choice(table, "kind", kFaults, "");
  if (action.kind == Action::Kind::BitErrorRate)
    action.rate = table.number_in("rate", 0, 1);
  else
    action.node = node_of(table, names);
  if (action.kind == Action::Kind::Delay)
    action.delay = from_ns(table.number_in("delay_ns", 0, 1e9));
  if (action.kind == Action::Kind::Id) action.value = whole(table, "id", 255);
  return action;
}

std::uint32_t read_protocol(const Config& table) {
  return choice(table, "protocol", kProtocols, "burst");
}

CardOptions read_cards(const Config& cards, const std::vector<Config>& faults,
                       const std::vector<std::string>& names) {
  CardOptions options;
  options.csr2 = read_protocol(cards);
  options.fibre_m = cards.number_in("fibre_m", 0, 1e6, options.fibre_m);
  options.strict_ids = cards.flag("strict_ids", false);
  options.bit_error_rate = cards.number_in("bit_error_rate", 0, 1, 0.0);
  cards.reject_unknown_keys();
  for (const Config& fault : faults) {
    Action action = read_fault(fault, names);
    action.at = from_ns(fault.number_in("at_s", 0, 1e5) * 1e9);
    options.faults.push_back({fault.has("node") ? fault.text("node") : "", action});
    fault.reject_unknown_keys();
  }
  std::stable_sort(options.faults.begin(), options.faults.end(),
                   [](const auto& a, const auto& b) { return a.action.at < b.action.at; });
  return options;
}

Scenario load_scenario(const std::filesystem::path& file) {
  const Config config = Config::load(file);
  return ScenarioReader{config}.take();
}

}  // namespace rths::replicated
