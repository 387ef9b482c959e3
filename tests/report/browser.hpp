// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "support/process.hpp"

namespace rths::report::test_support {

inline constexpr const char* kBrowser = "/usr/bin/chromium";

/// The document after its scripts have run, without a network.
/// @param profile  folder that the browser may use
inline std::string rendered(const std::filesystem::path& page,
                            const std::filesystem::path& profile) {
  return test::Running{{kBrowser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic",
                        "--no-first-run", "--disable-background-networking",
                        "--disable-component-update", "--disable-sync",
                        "--user-data-dir=" + profile.string(), "--virtual-time-budget=8000",
                        "--dump-dom", "file://" + page.string()}}
      .wait(60)
      .out;
}

/// The start of the body, where the pages say how many figures they drew and what went wrong.
inline std::string body_of(const std::string& page) {
  const auto begin = page.find("<body");
  return begin == std::string::npos ? "" : page.substr(begin, page.find('>', begin) - begin + 1);
}

}  // namespace rths::report::test_support
