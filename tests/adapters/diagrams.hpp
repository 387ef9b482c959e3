// SPDX-License-Identifier: Apache-2.0
//
// Block diagrams as text, for tests.
#pragma once

#include <memory>
#include <string>

#include <gtest/gtest.h>

#include <rths/adapters/simulink_like.hpp>

#include "support/files.hpp"

namespace rths::adapters::diagrams {

inline const std::string kHead = "diagram = 1\nbase_rate_Hz = 1000\nsubsteps = 10\n";

inline std::string input(const std::string& name, const std::string& signal,
                         const std::string& unit = "m") {
  return "[[block]]\nname = \"" + name + "\"\ntype = \"ring_input\"\nsignal = \"" + signal +
         "\"\nunit = \"" + unit + "\"\n";
}

inline std::string block(const std::string& name, const std::string& type,
                         const std::string& rest) {
  return "[[block]]\nname = \"" + name + "\"\ntype = \"" + type + "\"\n" + rest + "\n";
}

inline std::unique_ptr<Adapter> diagram(const std::string& blocks,
                                        const DiagramContext& context = {}) {
  return make_simulink_like_from_text(kHead + blocks, "d.toml", context);
}

inline std::string error_in(const std::string& blocks) {
  return test::error_of([&] { static_cast<void>(diagram(blocks)); });
}

inline Port port_named(const Adapter& adapter, const std::string& name) {
  for (const auto& port : adapter.ports())
    if (port.name == name) return port;
  ADD_FAILURE() << "there is no port " << name;
  return {};
}

inline const std::string kX = input("x", "lab.{axis}.displ");

}  // namespace rths::adapters::diagrams
