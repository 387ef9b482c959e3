// SPDX-License-Identifier: Apache-2.0
#include "figures.hpp"

#include <fmt/format.h>

#include <rths/session/figures.hpp>

#include "temporary_folder.hpp"

namespace rths::app {

void FiguresArguments::check() const {
  if (folder) session::check_figures_folder(*folder, replaces);
}

std::string FiguresArguments::write(const std::filesystem::path& page) const {
  if (!folder) return "";
  const TemporaryFolder scratch{"figures"};
  const std::size_t files = session::write_figures(page, *folder, scratch.path());
  return fmt::format("figures   {}: {} files\n", *folder, files);
}

CLI::Option* add_figures(CLI::App& command, FiguresArguments& figures) {
  auto* folder = command.add_option(
      "--figures", figures.folder,
      "Also write each figure of the page as PNG, SVG and CSV into this folder; needs Chromium");
  command.add_flag("--force", figures.replaces, "Replace figures of the same names in this folder")
      ->needs(folder);
  return folder;
}

}  // namespace rths::app
