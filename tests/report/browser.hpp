// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "support/process.hpp"

namespace rths::report::test_support {

inline constexpr const char* kBrowser = "/usr/bin/chromium";

/// Returns the document after its scripts ran, without a network.
/// @param profile  folder for the browser's own files
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

/// Returns the body's opening tag, in which a page counts its figures and reports errors.
inline std::string body_of(const std::string& page) {
  const auto begin = page.find("<body");
  return begin == std::string::npos ? "" : page.substr(begin, page.find('>', begin) - begin + 1);
}

}  // namespace rths::report::test_support
