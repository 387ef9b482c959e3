// SPDX-License-Identifier: Apache-2.0
#include "generic_client.hpp"

#include <cstring>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/realtime_guard.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Message = GenericClient::Message;

ElementMatrices matrices(Index n) {
  MatrixXd stiffness(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) stiffness(i, j) = static_cast<double>(10 * i + j + 1);
  return {stiffness, 2 * stiffness, 3 * stiffness};
}

template <class T>
std::vector<std::byte> bytes_of(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

std::vector<std::byte> sizes(std::int32_t n, std::int32_t doubles) {
  return bytes_of(std::vector<std::int32_t>{n, n, n, 0, 1, 0, 0, 0, n, 0, doubles});
}

std::vector<std::byte> request(std::size_t doubles, std::vector<double> first) {
  first.resize(doubles);
  return bytes_of(first);
}

std::vector<double> doubles_of(std::span<const std::byte> bytes) {
  std::vector<double> values(bytes.size() / sizeof(double));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TEST(GenericClient, ReadsSizesFirst) {
  GenericClient client{"element 'column'", 2};
  EXPECT_EQ(client.expected(), 44U);
  EXPECT_EQ(client.receive(sizes(2, 256)), Message::Sizes);
  EXPECT_EQ(client.expected(), 2048U);
}

TEST(GenericClient, SaysWhatIsWrongWithTheSizes) {
  const auto error_for = [](const std::vector<std::byte>& message) {
    GenericClient client{"element 'column'", 2};
    return test::error_of([&] { static_cast<void>(client.receive(message)); });
  };
  EXPECT_EQ(error_for(sizes(3, 256)),
            "element 'column': OpenSees lists 3 degrees of freedom, the experiment 2");
  EXPECT_EQ(error_for(sizes(2, 7)),
            "element 'column': messages of 7 numbers, expected 8 to 1048576");
  EXPECT_EQ(error_for(sizes(2, -1)),
            "element 'column': messages of -1 numbers, expected 8 to 1048576");
  EXPECT_EQ(
      error_for(bytes_of(std::vector<std::int32_t>{2, 2, 2, 2, 1, 0, 0, 0, 2, 0, 256})),
      "element 'column': its first message is [2, 2, 2, 2, 1, 0, 0, 0, 2, 0, 256], expected "
      "n displacements, 0 or n velocities and accelerations, 0 forces, 0 or 1 time, and in the "
      "reply n forces");
  EXPECT_NE(error_for(bytes_of(std::vector<std::int32_t>{2, 1, 0, 0, 0, 0, 0, 0, 2, 0, 256})), "");
  EXPECT_NE(error_for(bytes_of(std::vector<std::int32_t>{2, 0, 0, 0, 2, 0, 0, 0, 2, 0, 256})), "");
  EXPECT_NE(error_for(bytes_of(std::vector<std::int32_t>{2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 256})), "");
}

TEST(GenericClient, DistinguishesNewTrialsFromRepeatedOnes) {
  GenericClient client{"element", 2};
  static_cast<void>(client.receive(sizes(2, 256)));
  EXPECT_EQ(client.receive(request(256, {3})), Message::Trial);
  EXPECT_FALSE(client.is_new());  // the start at rest
  EXPECT_EQ(client.receive(request(256, {3, 0.1, 0.2, 1, 2, 3, 4, 0.02})), Message::Trial);
  EXPECT_TRUE(client.is_new());
  EXPECT_EQ(client.trial().displacement, (VectorXd{{0.1, 0.2}}));
  EXPECT_EQ(client.trial().velocity, (VectorXd{{1, 2}}));
  EXPECT_EQ(client.trial().acceleration, (VectorXd{{3, 4}}));
  EXPECT_EQ(client.trial().time, 0.02);
  EXPECT_EQ(client.receive(request(256, {3, 0.1, 0.2, 1.5, 2.5, 3, 4, 0.02})), Message::Trial);
  EXPECT_FALSE(client.is_new());
}

TEST(GenericClient, AnswersInColumns) {
  GenericClient client{"element", 2};
  static_cast<void>(client.receive(sizes(2, 256)));
  const auto answer = [&](double code) {
    EXPECT_EQ(client.receive(request(256, {code})), Message::MatrixRequest);
    auto values = doubles_of(client.matrix_reply(matrices(client.dofs())));
    EXPECT_EQ(values.size(), 256U);
    values.resize(5);
    return values;
  };
  using Values = std::vector<double>;
  EXPECT_EQ(answer(12), (Values{1, 11, 2, 12, 0}));
  EXPECT_EQ(answer(13), (Values{1, 11, 2, 12, 0}));
  EXPECT_EQ(answer(14), (Values{2, 22, 4, 24, 0}));
  EXPECT_EQ(answer(15), (Values{3, 33, 6, 36, 0}));
  EXPECT_EQ(client.receive(request(256, {10})), Message::MeasurementRequest);
  auto forces = doubles_of(client.measured_reply({VectorXd{{5, 6}}, VectorXd{{7, 8}}}));
  forces.resize(3);
  EXPECT_EQ(forces, (Values{7, 8, 0}));
  EXPECT_EQ(client.receive(request(256, {5})), Message::Commit);
  EXPECT_EQ(client.receive(request(256, {99})), Message::End);
}

TEST(GenericClient, TakesLongMessagesForManyDegreesOfFreedom) {
  for (const auto& [n, doubles] : {std::pair{16, 256}, {17, 289}, {100, 10000}}) {
    GenericClient client{"element", n};
    EXPECT_EQ(client.receive(sizes(n, doubles)), Message::Sizes);
    EXPECT_EQ(client.expected(), 8U * static_cast<std::size_t>(doubles));
  }
}

// OpenFresco's experimental elements expect all five quantities; the force is the fourth.
TEST(GenericClient, AnswersOpenFrescosElementsAtTheirOffsets) {
  GenericClient client{"element", 2};
  ASSERT_EQ(client.receive(bytes_of(std::vector<std::int32_t>{2, 2, 2, 0, 1, 2, 2, 2, 2, 1, 256})),
            Message::Sizes);
  ASSERT_EQ(client.receive(request(256, {3, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7})), Message::Trial);
  for (const double code : {6, 7, 8, 9, 10, 11})
    ASSERT_EQ(client.receive(request(256, {code})), Message::MeasurementRequest) << code;
  auto reply = doubles_of(client.measured_reply({VectorXd{{5, 6}}, VectorXd{{7, 8}}}));
  reply.resize(10);
  EXPECT_EQ(reply, (std::vector<double>{5, 6, 0.3, 0.4, 0.5, 0.6, 7, 8, 0.7, 0}));
}

// As does OpenFresco's own sample client in C.
TEST(GenericClient, AcceptsAClientThatSendsDisplacementsOnly) {
  GenericClient client{"element", 2};
  ASSERT_EQ(client.receive(bytes_of(std::vector<std::int32_t>{2, 0, 0, 0, 0, 2, 0, 0, 2, 0, 16})),
            Message::Sizes);
  EXPECT_EQ(client.expected(), 16 * sizeof(double));
  for (const double code : {1, 2, 4, 5})
    EXPECT_EQ(client.receive(request(16, {code})), Message::Commit);
  ASSERT_EQ(client.receive(request(16, {3, 0.1, 0.2, 99})), Message::Trial);
  EXPECT_TRUE(client.is_new());
  EXPECT_EQ(client.trial().displacement, (VectorXd{{0.1, 0.2}}));
  EXPECT_EQ(client.trial().velocity, VectorXd::Zero(2).eval());
  auto reply = doubles_of(client.measured_reply({VectorXd{{5, 6}}, VectorXd{{7, 8}}}));
  reply.resize(5);
  EXPECT_EQ(reply, (std::vector<double>{5, 6, 7, 8, 0}));
}

TEST(GenericClient, RefusesAMatrixThatDoesNotFit) {
  GenericClient client{"element", 3};
  ASSERT_EQ(client.receive(bytes_of(std::vector<std::int32_t>{3, 0, 0, 0, 0, 0, 0, 0, 3, 0, 8})),
            Message::Sizes);
  EXPECT_EQ(test::error_of([&] { static_cast<void>(client.receive(request(8, {12}))); }),
            "element: OpenSees requests a 3 x 3 matrix in messages of 8 numbers");
}

TEST(GenericClient, RejectsUnknownCodesAndKeepsTheLastTrial) {
  GenericClient client{"element", 1};
  static_cast<void>(client.receive(sizes(1, 256)));
  static_cast<void>(client.receive(request(256, {3, 0.5, 0, 0, 0.01})));
  EXPECT_EQ(test::error_of([&] { static_cast<void>(client.receive(request(256, {16}))); }),
            "element: OpenSees sent code 16, expected 1 to 15 or 99");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(client.receive(request(256, {3, nan})));
            }),
            "element: a trial state holds NaN or infinity");
  EXPECT_EQ(client.trial().displacement[0], 0.5);
}

// Each message is accepted or refused, and no trial ever holds NaN or infinity.
TEST(GenericClient, SurvivesMalformedMessages) {
  std::mt19937 random{7};
  std::uniform_int_distribution<int> any_byte{0, 255}, chance{0, 9};
  std::uniform_int_distribution<std::size_t> code{0, 9};
  constexpr double kCodes[] = {3, 5, 10, 12, 13, 14, 15, 99, 98, 6};
  // Sanitizers take ten times as long.
  const int messages = test::RealTimeGuard::supported() || test::is_long() ? 1'000'000 : 100'000;
  GenericClient client{"element", 1};
  int refused = 0;
  for (int i = 0; i < messages; ++i) {
    const bool is_first = client.expected() == 44;
    const std::size_t doubles = std::min<std::size_t>(client.expected() / sizeof(double), 64);
    std::vector<std::byte> message =
        is_first ? sizes(1, 8) : request(doubles, {kCodes[code(random)]});
    if (chance(random) < 7)
      for (int k = 0; k < 4; ++k)
        message[std::uniform_int_distribution<std::size_t>{0, message.size() - 1}(random)] =
            static_cast<std::byte>(any_byte(random));
    try {
      const Message kind = client.receive(message);
      if (kind == Message::MatrixRequest) {
        ASSERT_EQ(client.matrix_reply(matrices(client.dofs())).size(), client.expected());
      }
    } catch (const Error&) {
      ++refused;
    }
    ASSERT_TRUE(client.trial().displacement.allFinite());
    if (chance(random) == 0) client = GenericClient{"element", 1};
  }
  EXPECT_GT(refused, messages / 10);
}

}  // namespace
}  // namespace rths::adapters
