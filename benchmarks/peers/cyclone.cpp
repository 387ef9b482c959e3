// SPDX-License-Identifier: Apache-2.0
//
// Cyclone DDS over the loopback device; each side sleeps on a waitset until a sample arrives.
#include <stdlib.h>

#include <array>
#include <chrono>
#include <thread>
#include <vector>

#include <dds/dds.h>

#include <rths/core/error.hpp>

#include "message.h"
#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr auto kTimeout = std::chrono::seconds{10};
constexpr dds_duration_t kLongestSleep = DDS_SECS(5);

// Only on the loopback device, in a domain other than the default.
constexpr const char* kConfiguration =
    "<Domain><General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces>"
    "<AllowMulticast>false</AllowMulticast></General><Discovery><Peers>"
    "<Peer address=\"127.0.0.1\"/></Peers><ParticipantIndex>auto</ParticipantIndex></Discovery>"
    "</Domain>";
constexpr dds_domainid_t kDomain = 77;

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw Error{dds_strretcode(-entity)};
  return entity;
}

class TopicEnd {
 public:
  TopicEnd(bench::Side side, std::uint32_t bytes) : content_(bytes) {
    setenv("CYCLONEDDS_URI", kConfiguration, 1);
    participant_ = checked(dds_create_participant(kDomain, nullptr, nullptr));
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    writer_ = checked(dds_create_writer(participant_, topic(side), qos, nullptr));
    reader_ = checked(dds_create_reader(participant_, topic(bench::other(side)), qos, nullptr));
    dds_delete_qos(qos);
    arrival_ = checked(dds_create_waitset(participant_));
    dds_set_status_mask(reader_, DDS_DATA_AVAILABLE_STATUS);
    dds_waitset_attach(arrival_, reader_, 0);
    await_other_side();
  }
  ~TopicEnd() { dds_delete(participant_); }
  TopicEnd(const TopicEnd&) = delete;
  TopicEnd& operator=(const TopicEnd&) = delete;

  void send(std::uint32_t number) {
    mark(content_.data(), content_.size(), number);
    rths_peer_Message sample{};
    sample.content._buffer = content_.data();
    sample.content._length = sample.content._maximum = static_cast<std::uint32_t>(content_.size());
    checked(dds_write(writer_, &sample));
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    if (dds_waitset_wait(arrival_, nullptr, 0, kLongestSleep) == 0)
      throw Error{"a message did not arrive"};
    std::array<void*, 1> samples{};
    dds_sample_info_t info{};
    const dds_return_t count = checked(dds_take(reader_, samples.data(), &info, 1, 1));
    if (count == 0) return false;
    const auto& content = static_cast<const rths_peer_Message*>(samples[0])->content;
    const bool is_it = info.valid_data && number_of(content._buffer, content._length) == number;
    dds_return_loan(reader_, samples.data(), count);
    return is_it;
  }

 private:
  dds_entity_t topic(bench::Side writer) const {
    return checked(dds_create_topic(participant_, &rths_peer_Message_desc,
                                    writer == bench::Side::Near ? "near" : "far", nullptr,
                                    nullptr));
  }
  void await_other_side() const {
    const auto deadline = std::chrono::steady_clock::now() + kTimeout;
    dds_publication_matched_status_t readers{};
    dds_subscription_matched_status_t writers{};
    while (readers.current_count == 0 || writers.current_count == 0) {
      if (std::chrono::steady_clock::now() > deadline)
        throw Error{"the two sides did not discover each other"};
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
      dds_get_publication_matched_status(writer_, &readers);
      dds_get_subscription_matched_status(reader_, &writers);
    }
  }

  dds_entity_t participant_ = 0, writer_ = 0, reader_ = 0, arrival_ = 0;
  std::vector<std::uint8_t> content_;
};

bench::Times measure(const Request& request) {
  return bench::round_trips(request.setup, [&](bench::Side side) {
    return TopicEnd{side, request.bytes};
  });
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  return rths::peers::run_peer(argc, argv, {{"round_trips", rths::peers::measure}});
}
