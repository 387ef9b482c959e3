// SPDX-License-Identifier: Apache-2.0
#include "opensees_connection.hpp"

#include <poll.h>

namespace rths::adapters {
namespace {

constexpr int kMostRequests = 100;  // per call: OpenSees waits for each answer
constexpr auto kCheckEvery = std::chrono::milliseconds{100};  // whether OpenSees still runs
// Longest delay of a trial that was sent before a received request, beyond any acknowledgement.
constexpr auto kLongestDelay = std::chrono::milliseconds{300};

std::vector<ElementServer> listen(const OpenSeesSettings& settings) {
  std::vector<ElementServer> servers;
  for (const auto& element : settings.elements) servers.emplace_back(element);
  return servers;
}

}  // namespace

OpenSeesConnection::OpenSeesConnection(const OpenSeesSettings& settings)
    : settings_{settings}, servers_{listen(settings)}, opensees_{settings.script} {
  for (std::size_t i = 0; i < servers_.size(); ++i)
    servers_[i].admit({settings.elements[i].peer, opensees_.process()});
}

// Matrices are answered at once, because OpenSees may send a target next.
void OpenSeesConnection::receive(const std::vector<Specimen>& specimens) {
  for (std::size_t i = 0; i < servers_.size(); ++i)
    for (int request = 0; request < kMostRequests; ++request) {
      const bool has_received = servers_[i].receive();
      if (has_received) opensees_.restart_deadline();
      if (has_received && servers_[i].just_connected() && !settings_.elements[i].is_udp)
        opensees_.keep(servers_[i].descriptor());
      if (!servers_[i].matrix_requested() || !specimens[i].is_identified()) break;
      servers_[i].answer(specimens[i].matrices());
    }
  // After the trials: a script sends the accelerations of a step before the trial of the next one.
  if (auto* const floors = opensees_.floors()) floors->receive();
}

bool OpenSeesConnection::connected() const {
  return !any([](const auto& server) { return !server.connected(); });
}

bool OpenSeesConnection::disconnected() const {
  return !any([](const auto& server) { return !server.disconnected(); });
}

bool OpenSeesConnection::has_pending_trial() const {
  return any([](const auto& server) { return server.trials() > 0; });
}

bool OpenSeesConnection::has_open_request() const {
  return any([](const auto& server) {
    return server.measurement_requested() || server.matrix_requested();
  });
}

bool OpenSeesConnection::all_trials_received() const {
  const int first = servers_[0].trials();
  if (!any([&](const auto& server) { return server.trials() != first; })) return first > 0;
  // During model construction, an update may skip an element.
  return has_open_request() && opensees_.silence() > kLongestDelay;
}

void OpenSeesConnection::restart_deadline() { opensees_.restart_deadline(); }

Duration OpenSeesConnection::time_left() {
  const auto& script = settings_.script;
  const Duration left = connected()
                            ? opensees_.time_left(script.answer_deadline, "has sent no message for")
                            : opensees_.time_left(script.connect_deadline, "has not connected for");
  return std::min<Duration>(left, kCheckEvery);
}

void OpenSeesConnection::wait_for_input(Duration longest) const {
  std::vector<pollfd> sockets;
  for (const auto& server : servers_)
    if (!server.disconnected()) sockets.push_back({server.descriptor(), POLLIN, 0});
  const timespec timeout{longest / std::chrono::seconds{1},
                         (longest % std::chrono::seconds{1}).count()};
  ppoll(sockets.data(), sockets.size(), &timeout, nullptr);
}

bool OpenSeesConnection::has_finished() {
  return opensees_.has_finished(settings_.script.answer_deadline);
}

}  // namespace rths::adapters
