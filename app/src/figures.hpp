// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace rths::app {

/// The figures of a page that a command writes.
struct FiguresArguments {
  std::optional<std::string> folder;
  bool replaces = false;

  /// Before the command's work. @throws Error if the folder must not be used
  void check() const;
  /// Writes them. @returns a line for the terminal; empty: they are not asked for
  [[nodiscard]] std::string write(const std::filesystem::path& page) const;
};

/// Adds --figures and --force. @returns the first
CLI::Option* add_figures(CLI::App& command, FiguresArguments& figures);

}  // namespace rths::app
