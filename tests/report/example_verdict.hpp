// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/diagnosis/verdict.hpp>

namespace rths::report::test_support {

/// Verdicts about a mass on a spring that rubs, as a diagnosis might give them: motions, forces and
/// predictions are computed here, and all of them say that they are synthetic.
/// A machine whose guides rub, which the simulation leaves out.
[[nodiscard]] diagnosis::Verdict missing_verdict();
/// A simulation that leaves nothing out.
[[nodiscard]] diagnosis::Verdict none_verdict();
/// Something that depends on displacement and has no name.
[[nodiscard]] diagnosis::Verdict unknown_verdict();

}  // namespace rths::report::test_support
