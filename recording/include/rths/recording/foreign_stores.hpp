// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/recording/recording.hpp>

namespace rths::recording {

/// Stores to a word of the ring by processes that are not its owner, as far as they were seen.
struct ForeignStore {
  std::string signal;  ///< or the longword, if it has no signal
  std::string owner;   ///< its node; empty: no node owns the word
  double time = 0;     ///< of the first one, since the run began [s]
  std::string value;   ///< of the first one, with its SI unit
  std::size_t count = 0;
  std::string writers;  ///< "opf (process 12)": the programs of the cards, which may have made them
  [[nodiscard]] std::string found() const;  ///< value, writers and count
  [[nodiscard]] std::string expected() const;
  [[nodiscard]] std::string text() const;  ///< one line
};

/// Name of the text of /meta with the stores.
inline constexpr const char* kForeignStores = "foreign_stores";
/// The text: a line per word, with tabs between its fields.
[[nodiscard]] std::string to_text(const std::vector<ForeignStore>& stores);
/// As written; none in recordings of runs in virtual time, in which no other process has the ring.
/// @throws Error if the text is damaged
[[nodiscard]] std::vector<ForeignStore> foreign_stores_of(const Reader& run);

}  // namespace rths::recording
