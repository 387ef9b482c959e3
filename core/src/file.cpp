// SPDX-License-Identifier: Apache-2.0
#include <rths/core/file.hpp>

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw Error{fmt::format("{}: cannot be read: {}", file.string(), reason)};
}

}  // namespace

void check_is_file(const std::filesystem::path& file) {
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (status.type() == std::filesystem::file_type::directory) fail(file, "it is a directory");
  if (problem) fail(file, problem.message());
  if (status.type() != std::filesystem::file_type::regular)
    fail(file, "it is a device or a pipe, expected a file");
}

std::string read_file(const std::filesystem::path& file, std::uint64_t most_bytes) {
  check_is_file(file);
  std::ifstream stream{file, std::ios::binary};
  if (!stream) fail(file, std::strerror(errno));
  const std::uint64_t size = std::filesystem::file_size(file);
  if (size > most_bytes)
    fail(file, fmt::format("it has {} bytes, expected at most {}", size, most_bytes));
  std::string content(size, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(size));
  content.resize(static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) fail(file, std::strerror(errno));
  return content;
}

std::filesystem::path temporary_folder() {
  std::error_code problem;
  auto folder = std::filesystem::temp_directory_path(problem);
  if (!problem) return folder;
  for (const char* variable : {"TMPDIR", "TMP", "TEMP", "TEMPDIR"})
    if (const char* named = std::getenv(variable))
      throw Error{fmt::format("{}: no folder for temporary files: {}; the variable {} names it",
                              named, problem.message(), variable)};
  throw Error{fmt::format("/tmp: no folder for temporary files: {}", problem.message())};
}

std::optional<std::filesystem::path> found_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders{path == nullptr ? "/usr/bin:/bin" : path};
  for (std::string folder; std::getline(folders, folder, ':');)
    if (auto file = std::filesystem::path{folder} / program; access(file.c_str(), X_OK) == 0)
      return file;
  return std::nullopt;
}

}  // namespace rths
