// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::report::test_support {

inline constexpr const char* kBrowser = "/usr/bin/chromium";

/// Returns the document after its scripts ran, without a network.
/// @param profile  folder for the browser's own files
/// @param options  of the browser, in addition
inline std::string rendered(const std::filesystem::path& page, const std::filesystem::path& profile,
                            const std::vector<std::string>& options = {}) {
  std::vector<std::string> command{kBrowser,
                                   "--headless",
                                   "--no-sandbox",
                                   "--disable-gpu",
                                   "--disable-quic",
                                   "--no-first-run",
                                   "--disable-background-networking",
                                   "--disable-component-update",
                                   "--disable-sync",
                                   "--user-data-dir=" + profile.string(),
                                   "--virtual-time-budget=20000",
                                   "--dump-dom"};
  command.insert(command.end(), options.begin(), options.end());
  command.push_back("file://" + page.string());
  return test::Running{command}.wait(60).out;
}

/// Uses a page in dark mode as a person does: hovers, clicks, zooms, prints, narrows.
/// @param html    the page
/// @param probed  captions of the used figures, as a JavaScript object
/// @returns the answers of the page, one line each: probe.js
inline std::string probed(std::string html, const std::string& probed,
                          const test::TemporaryFolder& folder) {
  const std::string probe = test::content_of(test::source_tree() / "tests/report/probe.js");
  html.insert(html.rfind("</body>"),
              "<script>const probed = " + probed + ";\n" + probe + "</script>");
  const std::string page = rendered(folder.write("page.html", html), folder.path() / "profile",
                                    {"--blink-settings=preferredColorScheme=0",
                                     "--window-size=1280,1000", "--allow-file-access-from-files"});
  const auto begin = page.find("<pre id=\"probe\">");
  return begin == std::string::npos ? "no answers\n" + page.substr(0, 2000)
                                    : page.substr(begin, page.find("</pre>", begin) - begin);
}

/// Answers that every page gives.
inline const std::vector<std::string> kAnswers{
    "summaries: true",         "wide cards fit: true",      "wide page fits: true",
    "loop zooms: true",        "loop zooms out: true",      "legend hides: true",
    "legend shows: true",      "times zoom together: true", "times zoom out: true",
    "screen: rgb(18, 23, 28)", "paper: rgb(255, 255, 255)", "paper fits: true",
    "screen again: true",      "narrow cards fit: true",    "narrow page fits: true"};

/// Returns the body's opening tag, in which a page counts its figures and reports errors.
inline std::string body_of(const std::string& page) {
  const auto begin = page.find("<body");
  return begin == std::string::npos ? "" : page.substr(begin, page.find('>', begin) - begin + 1);
}

}  // namespace rths::report::test_support
