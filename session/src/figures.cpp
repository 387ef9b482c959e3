// SPDX-License-Identifier: Apache-2.0
#include <rths/session/figures.hpp>

#include <unistd.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/adapters/child_program.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/replace_files.hpp>
#include <rths/core/text.hpp>
#include <rths/session/folder.hpp>

namespace rths::session {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kBrowsers{"chromium", "chromium-browser", "google-chrome"};
constexpr Duration kLongestDrawing = std::chrono::seconds{120};
constexpr Duration kLongestQuit = std::chrono::seconds{3};
constexpr const char* kDrawn = "drawn.html";  // what the browser writes, in its folder

fs::path browser() {
  for (const auto& name : kBrowsers)
    if (const auto found = found_in_path(name)) return *found;
  throw Error{fmt::format(
      "the figures need Chromium, which draws them: none of {} is in PATH; install it, on Debian "
      "by 'apt install chromium'",
      fmt::join(kBrowsers, ", "))};
}

std::string url_of(const fs::path& page) {
  std::string url = "file://";
  for (const char c : fs::absolute(page).string())
    url += is_letter_or_digit(c) || std::string_view{"/-_.~"}.find(c) != std::string_view::npos
               ? std::string{c}
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return url;
}

adapters::ProgramStart drawing_of(const fs::path& page, const fs::path& scratch) {
  adapters::ProgramStart start;
  start.name = "Chromium";
  start.command = {"/bin/sh",
                   "-c",
                   fmt::format("exec \"$@\" > {}", kDrawn),
                   "sh",
                   browser().string(),
                   "--headless",
                   "--disable-gpu",
                   "--disable-background-networking",
                   "--disable-component-update",
                   "--disable-sync",
                   "--no-first-run",
                   "--user-data-dir=" + (scratch / "profile").string(),
                   "--dump-dom"};
  if (geteuid() == 0) start.command.emplace_back("--no-sandbox");  // it refuses root otherwise
  start.command.push_back(url_of(page) + "#figures");
  start.folder = scratch;
  start.log = scratch / "messages.txt";
  for (const char* folder : {"TMPDIR", "XDG_CACHE_HOME", "XDG_CONFIG_HOME"})
    start.environment.emplace_back(folder, scratch.string());
  start.is_favoured = false;
  return start;
}

// The page after its script has replaced it by its figures.
std::string drawn(const fs::path& page, const fs::path& scratch) {
  const Interruptible interruptible;
  adapters::ChildProgram program{drawing_of(page, scratch)};
  const WallClock clock;
  const TimePoint deadline = clock.now() + kLongestDrawing;
  while (!program.wait(std::chrono::milliseconds{100}) && !is_interrupted() &&
         clock.now() < deadline)
    continue;
  const bool has_ended = program.has_ended();
  if (!has_ended) {  // its processes end in order, so that they do not write any more
    program.ask_to_end();
    program.wait(kLongestQuit);
  }
  stop_if_interrupted();
  if (!has_ended)
    throw Error{fmt::format("{}: Chromium has not drawn its figures within {:g} s", page.string(),
                            to_seconds(kLongestDrawing))};
  return read_file(scratch / kDrawn, kMostTextBytes);
}

std::string bytes_of(std::string_view base64) {
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : base64) {
    const std::uint32_t six = c >= 'A' && c <= 'Z'   ? static_cast<std::uint32_t>(c - 'A')
                              : c >= 'a' && c <= 'z' ? static_cast<std::uint32_t>(c - 'a' + 26)
                              : is_digit(c)          ? static_cast<std::uint32_t>(c - '0' + 52)
                              : c == '+'             ? 62U
                                                     : 63U;
    if (c == '=') break;
    group = group << 6U | six;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> static_cast<unsigned>(bits) & 0xFFU);
  }
  return bytes;
}

}  // namespace

void check_figures_folder(const fs::path& folder, bool replaces) {
  std::error_code error;
  if (folder.empty()) throw Error{"the folder for the figures has no name"};
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw Error{folder.string() + ": is no folder, expected one for the figures"};
  if (!replaces && fs::exists(folder, error) && !fs::is_empty(folder, error))
    throw Error{folder.string() +
                ": has files, expected a new folder for the figures, or --force to replace those "
                "of the same names"};
}

std::size_t write_figures(const fs::path& page, const fs::path& folder, const fs::path& scratch) {
  constexpr std::string_view kBegin = "<pre id=\"figures\">", kEnd = "</pre>";
  const std::string document = drawn(page, scratch);
  const auto begin = document.find(kBegin);
  const auto end = document.find(kEnd, begin);
  if (begin == std::string::npos || end == std::string::npos)
    throw Error{page.string() +
                ": Chromium has not drawn its figures: the page is of another version, or "
                "the disk is full; write it anew"};
  create_folder(folder);
  Replacements files;
  std::size_t count = 0;
  const auto text =
      std::string_view{document}.substr(begin + kBegin.size(), end - begin - kBegin.size());
  for (const auto line : lines_of(text)) {
    const auto parts = cells_of(line, ' ');
    if (parts.size() != 2) continue;
    files.add(folder / std::string{parts[0]}, bytes_of(parts[1]));
    ++count;
  }
  files.commit();
  return count;
}

}  // namespace rths::session
