// SPDX-License-Identifier: Apache-2.0
#include "ground_motion.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>

namespace trial {
namespace {

namespace fs = std::filesystem;

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  std::istringstream cells{line};
  for (std::string cell; std::getline(cells, cell, ',');) numbers.push_back(std::stod(cell));
  return numbers;
}

GroundMotion read(const fs::path& file) {
  std::ifstream in{file};
  std::string line;
  std::getline(in, line);
  GroundMotion motion{.name = file.stem().string()};
  std::vector<double> times;
  while (std::getline(in, line)) {
    const std::vector<double> row = numbers_of(line);
    if (row.size() < 3) throw std::runtime_error(file.string() + ": a row has too few columns");
    times.push_back(row[0]);
    motion.first.push_back(row[1]);
    motion.second.push_back(row[2]);
    if (row.size() > 3) motion.vertical.push_back(row[3]);
  }
  if (times.size() < 2) throw std::runtime_error(file.string() + ": no ground motion");
  motion.step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  motion.has_vertical = motion.vertical.size() == motion.first.size();
  return motion;
}

std::vector<GroundMotion> read_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder))
    for (const auto& entry : fs::directory_iterator{folder})
      if (entry.path().extension() == ".csv") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<GroundMotion> motions;
  for (const fs::path& file : files) motions.push_back(read(file));
  return motions;
}

// Noise between about 0.3 and 2 Hz with the envelope of `like`.
std::vector<double> modulated_noise(const std::vector<double>& like, double step, Random& random) {
  const double fast = std::exp(-2 * std::numbers::pi * 2 * step);
  const double slow = std::exp(-2 * std::numbers::pi * 0.3 * step);
  const double envelope_keeps = std::exp(-step / 2.0);
  double rough = 0, quick = 0, trend = 0, envelope = 0;
  std::vector<double> noise;
  for (const double value : like) {
    rough = fast * rough + (1 - fast) * random.gaussian();
    quick = fast * quick + (1 - fast) * rough;
    trend = slow * trend + (1 - slow) * quick;
    envelope = envelope_keeps * envelope + (1 - envelope_keeps) * value * value;
    noise.push_back((quick - trend) * std::sqrt(envelope));
  }
  return noise;
}

GroundMotion variant(const GroundMotion& motion, std::uint64_t number) {
  Random random{0x6d6f74696f6e, number};
  GroundMotion made = motion;
  made.name += "_noise_" + std::to_string(number);
  made.first = modulated_noise(motion.first, motion.step, random);
  made.second = modulated_noise(motion.second, motion.step, random);
  return made;
}

}  // namespace

std::vector<GroundMotion> read_ground_motions(const fs::path& motions, const fs::path& records) {
  std::vector<GroundMotion> found = read_folder(motions);
  if (found.size() >= 3) return found;
  found = read_folder(records);
  if (found.empty())
    throw std::runtime_error("no ground motions in " + motions.string() + " nor in " +
                             records.string());
  const std::vector<GroundMotion> recorded = found;
  for (std::uint64_t number = 1; number <= 4; ++number)
    for (const GroundMotion& motion : recorded) found.push_back(variant(motion, number));
  return found;
}

}  // namespace trial
