// SPDX-License-Identifier: Apache-2.0
#include "samples.hpp"

#include <algorithm>
#include <cstring>
#include <vector>

#include <dds/dds.h>
#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>

#include "frame.h"

namespace rths::bench {
namespace {

constexpr Duration kLongestAnswer = std::chrono::seconds{60};
constexpr const char* kLoopback =
    "<CycloneDDS><Domain id=\"any\"><General><Interfaces><NetworkInterface address=\"127.0.0.1\"/>"
    "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto"
    "</ParticipantIndex><MaxAutoParticipantIndex>32</MaxAutoParticipantIndex><Peers><Peer "
    "address=\"127.0.0.1\"/></Peers></Discovery></Domain></CycloneDDS>";

dds_entity_t checked(dds_entity_t entity) {
  if (entity < 0) throw Error{fmt::format("DDS cannot start: {}", dds_strretcode(-entity))};
  return entity;
}

}  // namespace

struct Samples::Entities {
  dds_entity_t participant = 0, writer = 0, reader = 0, arrival = 0;

  void send(const void* bytes, std::size_t size) const {
    rths_dds_Bytes sample{};
    sample.content._buffer = static_cast<std::uint8_t*>(const_cast<void*>(bytes));
    sample.content._length = sample.content._maximum = static_cast<std::uint32_t>(size);
    if (dds_write(writer, &sample) != DDS_RETCODE_OK) throw Error{"a sample could not be sent"};
  }
  [[nodiscard]] bool take(Message& message) const {
    void* sample = nullptr;
    dds_sample_info_t info{};
    const dds_return_t count = dds_take(reader, &sample, &info, 1, 1);
    if (count <= 0) return false;
    if (info.valid_data) {
      const auto& content = static_cast<const rths_dds_Bytes*>(sample)->content;
      std::memcpy(&message, content._buffer,
                  std::min<std::size_t>(content._length, sizeof message));
    }
    dds_return_loan(reader, &sample, count);
    return info.valid_data;
  }
};

Samples::Samples(std::uint32_t domain) : entities_{std::make_unique<Entities>()} {
  Entities& e = *entities_;
  checked(dds_create_domain(domain, kLoopback));
  e.participant = checked(dds_create_participant(domain, nullptr, nullptr));
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
  dds_qset_ignorelocal(qos, DDS_IGNORELOCAL_PARTICIPANT);
  const dds_entity_t topic = checked(
      dds_create_topic(e.participant, &rths_dds_Bytes_desc, "rths_bridge_bench", nullptr, nullptr));
  e.writer = checked(dds_create_writer(e.participant, topic, qos, nullptr));
  e.reader = checked(dds_create_reader(e.participant, topic, qos, nullptr));
  dds_delete_qos(qos);
  e.arrival = checked(dds_create_waitset(e.participant));
  dds_set_status_mask(e.reader, DDS_DATA_AVAILABLE_STATUS);
  dds_waitset_attach(e.arrival, e.reader, 0);
}

Samples::~Samples() { dds_delete(entities_->participant); }

void Samples::send(const Message& message) { entities_->send(&message, sizeof message); }

void Samples::send_bytes(std::size_t bytes) {
  std::vector<std::byte> buffer(bytes);
  const std::uint64_t kind = Message::kSample;
  std::memcpy(buffer.data(), &kind, std::min(bytes, sizeof kind));
  entities_->send(buffer.data(), buffer.size());
}

Message Samples::receive() {
  const WallClock clock;
  const TimePoint deadline = clock.now() + kLongestAnswer;
  Message message;
  while (!entities_->take(message)) {
    if (clock.now() > deadline) throw Error{"the other process does not answer"};
    dds_waitset_wait(entities_->arrival, nullptr, 0, DDS_MSECS(100));
  }
  return message;
}

}  // namespace rths::bench
