// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/low_pass.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <type_traits>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::maths {
namespace {

constexpr std::size_t kMostSections = 4;

}  // namespace

LowPass::LowPass(int order, double cutoff, double period) {
  if (order < 2 || order > 2 * static_cast<int>(kMostSections) || order % 2 != 0)
    throw Error{fmt::format("low-pass: order is {}, expected 2, 4, 6 or 8", order)};
  if (!(period > 0) || !(cutoff > 0) || cutoff * period >= 0.5)
    throw Error{
        fmt::format("low-pass: a cut-off of {} Hz needs a sampling rate above twice that", cutoff)};
  const double k = std::tan(std::numbers::pi * cutoff * period);
  for (int i = 0; i < order / 2; ++i) {
    // Pole pair of the analogue prototype: s² + (1/Q) s + 1.
    const double inverse_q = 2 * std::sin(std::numbers::pi * (2 * i + 1) / (2.0 * order));
    const double norm = 1 / (1 + k * inverse_q + k * k);
    sections_.push_back({k * k * norm, 2 * (k * k - 1) * norm, (1 - k * inverse_q + k * k) * norm});
  }
}

double LowPass::operator()(double input) noexcept {
  filter({&input, 1});
  return input;
}

// Calls with the number of sections as a constant, so that the compiler unrolls their loop.
template <class Call>
void LowPass::with_sections(const Call& call) const noexcept {
  switch (sections_.size()) {
    case 1:
      return call(std::integral_constant<std::size_t, 1>{});
    case 2:
      return call(std::integral_constant<std::size_t, 2>{});
    case 3:
      return call(std::integral_constant<std::size_t, 3>{});
    default:
      return call(std::integral_constant<std::size_t, kMostSections>{});
  }
}

void LowPass::filter(std::span<double> signal) noexcept {
  with_sections([&](auto sections) { filter_by<sections>(signal); });
}

// Coefficients and state are local, so that the compiler keeps them in registers.
template <std::size_t kSections>
void LowPass::filter_by(std::span<double> signal) noexcept {
  std::array<Section, kSections> sections;
  std::copy_n(sections_.begin(), kSections, sections.begin());
  for (double& sample : signal) {
    double value = sample;
    for (auto& s : sections) {
      const double out = s.b0 * value + s.z1;
      s.z1 = 2 * s.b0 * value - s.a1 * out + s.z2;
      s.z2 = s.b0 * value - s.a2 * out;
      value = out;
    }
    sample = value;
  }
  std::copy(sections.begin(), sections.end(), sections_.begin());
}

void LowPass::filter_four(std::span<std::array<double, 4>> signals) const noexcept {
  with_sections([&](auto sections) { filter_four_by<sections>(signals); });
}

// Each sample waits for the one before it. Four independent signals fill this time.
template <std::size_t kSections>
void LowPass::filter_four_by(std::span<std::array<double, 4>> signals) const noexcept {
  struct Delays {
    Eigen::Array4d z1 = Eigen::Array4d::Zero(), z2 = Eigen::Array4d::Zero();
  };
  std::array<Delays, kSections> delays;
  for (auto& samples : signals) {
    Eigen::Array4d value = Eigen::Map<const Eigen::Array4d>{samples.data()};
    for (std::size_t i = 0; i < kSections; ++i) {
      const Section& s = sections_[i];
      const Eigen::Array4d out = s.b0 * value + delays[i].z1;
      delays[i].z1 = 2 * s.b0 * value - s.a1 * out + delays[i].z2;
      delays[i].z2 = s.b0 * value - s.a2 * out;
      value = out;
    }
    Eigen::Map<Eigen::Array4d>{samples.data()} = value;
  }
}

}  // namespace rths::maths
