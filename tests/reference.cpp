// SPDX-License-Identifier: Apache-2.0
// A source of fixed content: `./lab test` prints how long the compiler takes for it, as a measure
// of the machine.
#include <algorithm>
#include <functional>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include <Eigen/Core>

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }

bool matches(const std::string& text, const std::string& pattern) {
  return std::regex_match(text, std::regex{pattern});
}

std::map<std::string, std::vector<double>> sorted(std::map<std::string, std::vector<double>> rows) {
  for (auto& [name, values] : rows) std::sort(values.begin(), values.end(), std::greater<>{});
  return rows;
}
