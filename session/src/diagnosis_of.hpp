// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/session/diagnose.hpp>
#include <rths/session/folder.hpp>

namespace rths::session {

/// The folder of a verdict, locked until it is destroyed. One that was made and is empty is then
/// removed.
class VerdictFolder {
 public:
  /// @param inputs  files that the verdict must not replace
  /// @throws Error if the folder is in use, or the verdict would replace other files
  VerdictFolder(const std::filesystem::path& folder,
                const std::vector<std::filesystem::path>& inputs);

 private:
  NewFolder made_;
  FolderLock lock_;
};

/// What a recording is of.
enum class TestState { Running, Ended };

/// The case of a path, as a user states it. @throws Error
[[nodiscard]] diagnosis::Case case_of(const DiagnoseSettings& settings);

/// Diagnoses a case and writes its verdict, with the mismatch budget of a run that has ended.
/// @param c  of `settings`
/// @param folder  locked by the caller
/// @throws Error, Interrupted
DiagnosisResult diagnose_into(const std::filesystem::path& folder, const diagnosis::Case& c,
                              const DiagnoseSettings& settings, TestState state,
                              const Progress& progress);

}  // namespace rths::session
