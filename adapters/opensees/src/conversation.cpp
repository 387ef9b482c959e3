// SPDX-License-Identifier: Apache-2.0
#include "conversation.hpp"

#include <poll.h>

namespace rths::adapters {
namespace {

constexpr int kMostQuestions = 100;  // at once: OpenSees waits for each answer
constexpr auto kLookEvery = std::chrono::milliseconds{100};  // whether OpenSees still runs
// For a trial that was sent before a question that is here: far longer than any acknowledgement.
constexpr auto kLongestOnTheWay = std::chrono::milliseconds{300};

std::vector<ElementServer> listen(const OpenSeesSettings& settings) {
  std::vector<ElementServer> servers;
  for (const auto& element : settings.elements) servers.emplace_back(element);
  return servers;
}

}  // namespace

Conversation::Conversation(const OpenSeesSettings& settings)
    : settings_{settings}, servers_{listen(settings)}, opensees_{settings.script} {}

// Matrices are answered at once: what OpenSees says next may be a target.
void Conversation::hear(const std::vector<Specimen>& specimens) {
  for (std::size_t i = 0; i < servers_.size(); ++i)
    for (int heard = 0; heard < kMostQuestions; ++heard) {
      const bool is_news = servers_[i].hear();
      if (is_news) opensees_.heard();
      if (is_news && servers_[i].has_just_come() && !settings_.elements[i].is_udp)
        opensees_.keep(servers_[i].descriptor());
      if (!servers_[i].wants_matrix() || !specimens[i].is_known()) break;
      servers_[i].answer(specimens[i].matrices());
    }
}

bool Conversation::has_come() const {
  return !any([](const auto& server) { return !server.has_come(); });
}

bool Conversation::has_left() const {
  return !any([](const auto& server) { return !server.has_left(); });
}

bool Conversation::has_trials() const {
  return any([](const auto& server) { return server.trials() > 0; });
}

bool Conversation::is_question_open() const {
  return any([](const auto& server) { return server.wants_measured() || server.wants_matrix(); });
}

bool Conversation::is_round_complete() const {
  const int first = servers_[0].trials();
  if (!any([&](const auto& server) { return server.trials() != first; })) return first > 0;
  // An element that this update does not tell, as while others are being made.
  return is_question_open() && opensees_.silence() > kLongestOnTheWay;
}

void Conversation::pass_turn() { opensees_.heard(); }

Duration Conversation::patience() {
  const auto& script = settings_.script;
  const Duration left = has_come()
                            ? opensees_.patience(script.answer_deadline, "has been silent for")
                            : opensees_.patience(script.connect_deadline, "has not come for");
  return std::min<Duration>(left, kLookEvery);
}

void Conversation::wait_for_news(Duration longest) const {
  std::vector<pollfd> news;
  for (const auto& server : servers_)
    if (!server.has_left()) news.push_back({server.descriptor(), POLLIN, 0});
  const timespec patience{longest / std::chrono::seconds{1},
                          (longest % std::chrono::seconds{1}).count()};
  ppoll(news.data(), news.size(), &patience, nullptr);
}

bool Conversation::has_finished() {
  return opensees_.has_finished(settings_.script.answer_deadline);
}

}  // namespace rths::adapters
