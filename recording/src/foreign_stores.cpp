// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/foreign_stores.hpp>

#include <sstream>

#include <fmt/format.h>

#include <rths/core/text.hpp>

namespace rths::recording {
std::string ForeignStore::found() const {
  return fmt::format("{} by {}, seen {}", value, writers,
                     count == 1 ? "once" : fmt::format("{} times", count));
}

std::string ForeignStore::expected() const {
  return owner.empty() ? "no store, because no node owns the word"
                       : fmt::format("stores by its owner {} alone", owner);
}

std::string ForeignStore::text() const {
  return fmt::format("{} at {:.3f} s: stored as {}, expected {}", signal, time, found(),
                     expected());
}

std::string to_text(const std::vector<ForeignStore>& stores) {
  constexpr std::size_t kMost = 60'000;  // an attribute of HDF5 has less than 64 KiB
  std::string text;
  for (const auto& store : stores)
    if (text.size() < kMost)
      text += fmt::format("{:.6f}\t{}\t{}\t{}\t{}\t{}\n", store.time, store.signal, store.owner,
                          store.value, store.count, store.writers);
  return text;
}

std::vector<ForeignStore> foreign_stores_of(const Reader& run) {
  const auto meta = run.meta();
  const auto found = meta.find(kForeignStores);
  if (found == meta.end()) return {};
  std::vector<ForeignStore> stores;
  std::istringstream lines{found->second};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields{line};
    ForeignStore store;
    std::string time, count;
    for (std::string* field :
         {&time, &store.signal, &store.owner, &store.value, &count, &store.writers})
      std::getline(fields, *field, '\t');
    const auto seconds = number_of(time);
    if (!seconds || count.empty() || count.find_first_not_of("0123456789") != std::string::npos)
      throw Error{
          fmt::format("/meta/{}: the line is '{}', expected six fields", kForeignStores, line)};
    store.time = *seconds;
    store.count = std::stoul(count);
    stores.push_back(std::move(store));
  }
  return stores;
}

}  // namespace rths::recording
