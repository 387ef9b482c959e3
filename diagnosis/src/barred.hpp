// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/diagnosis/case.hpp>

namespace rths::diagnosis {

/// Checks that terms which may not be named are known: kinds of the catalogue, or names as verdicts
/// have them.
/// @throws Error for the first that is neither, with the nearest that is   @setup
void reject_unknown_terms(const std::vector<std::string>& without, const Case& c);

/// Whether a name or its kind is among them.
[[nodiscard]] bool is_barred(const std::vector<std::string>& without, const std::string& name,
                             const std::string& kind);

}  // namespace rths::diagnosis
