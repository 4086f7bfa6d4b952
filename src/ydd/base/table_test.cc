// SPDX-License-Identifier: Apache-2.0
#include "ydd/base/table.h"

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <unordered_set>

#include <gtest/gtest.h>

namespace ydd {
namespace {

struct AnimalTag;
struct PlantTag;
using Animals = Table<std::string, AnimalTag>;
using AnimalId = Id<AnimalTag>;

static_assert(!std::is_convertible_v<Id<AnimalTag>, Id<PlantTag>>, "ids of tags must not mix");
static_assert(!std::is_copy_constructible_v<Animals>, "copies are taken by snapshot() only");

TEST(Id, IsInvalidByDefault) {
  EXPECT_FALSE(AnimalId().valid());
  EXPECT_TRUE((AnimalId{0, 1}.valid()));
}

TEST(Id, OrdersBySlotThenGenerationAndHashes) {
  EXPECT_LT((AnimalId{1, 9}), (AnimalId{2, 1}));
  EXPECT_LT((AnimalId{1, 1}), (AnimalId{1, 2}));
  EXPECT_EQ((AnimalId{3, 4}), (AnimalId{3, 4}));
  const std::unordered_set<AnimalId> set{{1, 1}, {1, 2}, {2, 1}, {1, 1}};
  EXPECT_EQ(set.size(), 3U);
}

TEST(Table, FindsWhatWasInserted) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  const AnimalId dog = animals.insert("dog");
  EXPECT_EQ(animals.size(), 2U);
  EXPECT_EQ(animals.at(cat), "cat");
  ASSERT_NE(animals.find(dog), nullptr);
  EXPECT_EQ(*animals.find(dog), "dog");
  EXPECT_TRUE(animals.contains(dog));
}

TEST(Table, StaleAndEmptyIdsFindNothingAndThrowWhenUsed) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  animals.erase(cat);
  EXPECT_TRUE(animals.empty());
  for (const AnimalId id : {cat, AnimalId(), AnimalId{0, 7}, AnimalId{5000, 1}}) {
    EXPECT_EQ(animals.find(id), nullptr);
    EXPECT_THROW(animals.at(id), std::logic_error);
    EXPECT_THROW(animals.edit(id), std::logic_error);
    EXPECT_THROW(animals.erase(id), std::logic_error);
  }
}

TEST(Table, AReusedSlotDoesNotAnswerToTheOldId) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  animals.erase(cat);
  const AnimalId dog = animals.insert("dog");
  EXPECT_EQ(dog.slot, cat.slot);
  EXPECT_NE(dog.generation, cat.generation);
  EXPECT_EQ(animals.find(cat), nullptr);
  EXPECT_EQ(animals.at(dog), "dog");
  EXPECT_EQ(animals.slots(), 1U);
}

TEST(Table, ReusesTheSlotFreedLast) {
  Animals animals;
  const AnimalId a = animals.insert("a");
  const AnimalId b = animals.insert("b");
  animals.insert("c");
  animals.erase(a);
  animals.erase(b);
  EXPECT_EQ(animals.insert("d").slot, b.slot);
  EXPECT_EQ(animals.insert("e").slot, a.slot);
  EXPECT_EQ(animals.insert("f").slot, 3U);
}

TEST(Table, ASnapshotIsUntouchedByLaterEdits) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  const AnimalId dog = animals.insert("dog");
  const Animals before = animals.snapshot();
  animals.edit(cat) = "tiger";
  animals.erase(dog);
  const AnimalId owl = animals.insert("owl");  // takes the slot of dog

  EXPECT_EQ(before.size(), 2U);
  EXPECT_EQ(before.at(cat), "cat");
  EXPECT_EQ(before.at(dog), "dog");
  EXPECT_EQ(before.find(owl), nullptr);
  EXPECT_EQ(animals.at(cat), "tiger");
  EXPECT_EQ(animals.find(dog), nullptr);
  EXPECT_EQ(animals.at(owl), "owl");
}

TEST(Table, EveryGenerationOfSnapshotsKeepsItsOwnState) {
  Animals animals;
  const AnimalId id = animals.insert("0");
  std::vector<Animals> history;
  for (int i = 1; i <= 5; ++i) {
    history.push_back(animals.snapshot());
    animals.edit(id) = std::to_string(i);
    animals.edit(id) += "!";
  }
  EXPECT_EQ(history[0].at(id), "0");
  for (int i = 1; i < 5; ++i) EXPECT_EQ(history[i].at(id), std::to_string(i) + "!");
  EXPECT_EQ(animals.at(id), "5!");
}

TEST(Table, AnEditedSnapshotDoesNotReachBack) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  Animals copy = animals.snapshot();
  copy.edit(cat) = "lion";
  EXPECT_EQ(animals.at(cat), "cat");
  animals.edit(cat) = "tiger";
  EXPECT_EQ(copy.at(cat), "lion");
  Animals copy_of_copy = copy.snapshot();
  copy.edit(cat) = "lynx";
  copy_of_copy.edit(cat) = "puma";
  EXPECT_EQ(animals.at(cat), "tiger");
  EXPECT_EQ(copy.at(cat), "lynx");
  EXPECT_EQ(copy_of_copy.at(cat), "puma");
}

TEST(Table, UneditedValuesAreSharedWithTheSnapshot) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  const AnimalId dog = animals.insert("dog");
  const Animals before = animals.snapshot();
  animals.edit(cat) = "tiger";
  EXPECT_NE(before.find(cat), animals.find(cat));
  EXPECT_EQ(before.find(dog), animals.find(dog));
}

TEST(Table, EditsWithoutASnapshotDoNotClone) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  const std::string* const place = animals.find(cat);
  animals.edit(cat) = "tiger";
  EXPECT_EQ(animals.find(cat), place);
  const Animals before = animals.snapshot();
  animals.edit(cat) = "lion";
  const std::string* const cloned = animals.find(cat);
  EXPECT_NE(cloned, place);
  animals.edit(cat) = "lynx";
  EXPECT_EQ(animals.find(cat), cloned);
}

TEST(Table, VisitsInSlotOrderAcrossChunks) {
  Table<int, AnimalTag> numbers;
  std::vector<AnimalId> ids;
  for (int i = 0; i < 200; ++i) ids.push_back(numbers.insert(i));
  for (int i = 0; i < 200; i += 3) numbers.erase(ids[i]);
  std::vector<int> seen;
  numbers.for_each([&](AnimalId id, const int& value) {
    EXPECT_EQ(numbers.at(id), value);
    seen.push_back(value);
  });
  std::vector<int> expected;
  for (int i = 0; i < 200; ++i) {
    if (i % 3 != 0) expected.push_back(i);
  }
  EXPECT_EQ(seen, expected);
  EXPECT_EQ(numbers.ids().size(), expected.size());
  EXPECT_EQ(numbers.slots(), 200U);
}

TEST(Table, MovedTablesKeepTheirIds) {
  Animals animals;
  const AnimalId cat = animals.insert("cat");
  const Animals moved = std::move(animals);
  EXPECT_EQ(moved.at(cat), "cat");
}

/// The table against a plain map, with snapshots taken on the way.
TEST(Table, AgreesWithAMapUnderRandomEdits) {
  using Model = std::map<AnimalId, int>;
  std::mt19937 random(11);
  Table<int, AnimalTag> table;
  Model model;
  std::vector<std::pair<Table<int, AnimalTag>, Model>> history;
  std::vector<AnimalId> known;
  for (int step = 0; step < 4000; ++step) {
    const auto action = random() % 10;
    const AnimalId id = known.empty() ? AnimalId() : known[random() % known.size()];
    if (action < 4) {
      const AnimalId fresh = table.insert(step);
      EXPECT_FALSE(model.contains(fresh));
      model[fresh] = step;
      known.push_back(fresh);
    } else if (action < 7 && model.contains(id)) {
      table.edit(id) = -step;
      model[id] = -step;
    } else if (action < 9 && model.contains(id)) {
      table.erase(id);
      model.erase(id);
    } else if (step % 16 == 0) {
      history.emplace_back(table.snapshot(), model);
    }
  }
  history.emplace_back(table.snapshot(), model);
  ASSERT_GT(history.size(), 5U);
  for (const auto& [snapshot, expected] : history) {
    EXPECT_EQ(snapshot.size(), expected.size());
    for (const AnimalId id : known) {
      const auto found = expected.find(id);
      const int* value = snapshot.find(id);
      ASSERT_EQ(value != nullptr, found != expected.end());
      if (value) {
        EXPECT_EQ(*value, found->second);
      }
    }
  }
}

/// For the thread sanitizer: readers of a snapshot while the owner edits on.
TEST(Table, SnapshotsCanBeReadWhileTheOwnerEdits) {
  Table<int, AnimalTag> table;
  std::vector<AnimalId> ids;
  for (int i = 0; i < 300; ++i) ids.push_back(table.insert(i));
  for (int round = 0; round < 20; ++round) {
    auto snapshot = std::make_shared<const Table<int, AnimalTag>>(table.snapshot());
    int first_sum = 0;
    snapshot->for_each([&](AnimalId, int value) { first_sum += value; });
    int second_sum = 0;
    std::jthread reader([snapshot = std::move(snapshot), &second_sum] {
      snapshot->for_each([&](AnimalId, int value) { second_sum += value; });
    });
    for (const AnimalId id : ids) table.edit(id) += 1;
    reader.join();
    EXPECT_EQ(first_sum, second_sum);
  }
}

TEST(Table, ComesBackFromItsPartsDownToTheIdsItWillGive) {
  Table<int, AnimalTag> table;
  std::vector<AnimalId> ids;
  for (int i = 0; i < 150; ++i) ids.push_back(table.insert(i));
  for (const int gone : {3, 70, 149, 4}) table.erase(ids[static_cast<std::size_t>(gone)]);
  ids[70] = table.insert(700);  // slot 4 again
  std::vector<std::pair<AnimalId, int>> values;
  table.for_each([&](AnimalId id, int value) { values.emplace_back(id, value); });
  auto restored = Table<int, AnimalTag>::restore(values, table.freed());
  ASSERT_TRUE(restored.has_value());
  EXPECT_EQ(restored->size(), table.size());
  EXPECT_EQ(restored->ids(), table.ids());
  EXPECT_EQ(restored->find(ids[3]), nullptr);
  EXPECT_EQ(restored->at(ids[70]), 700);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(restored->insert(i), table.insert(i));
  const auto snapshot = restored->snapshot();
  restored->edit(ids[0]) = -1;
  EXPECT_EQ(snapshot.at(ids[0]), 0);
}

TEST(Table, PartsThatLeaveGapsOrOverlapGiveNothing) {
  using Numbers = Table<int, AnimalTag>;
  EXPECT_TRUE(Numbers::restore({}, {}).has_value());
  EXPECT_TRUE(Numbers::restore({{{1, 1}, 5}}, {{0, 2}}).has_value());
  EXPECT_FALSE(Numbers::restore({{{1, 1}, 5}}, {}).has_value());
  EXPECT_FALSE(Numbers::restore({{{0, 1}, 5}, {{0, 2}, 6}}, {}).has_value());
  EXPECT_FALSE(Numbers::restore({{{0, 1}, 5}}, {{0, 1}}).has_value());
  EXPECT_FALSE(Numbers::restore({{{0, 0}, 5}}, {}).has_value());
}

/// The slots that a walk over the differences visits.
std::vector<std::uint32_t> visited(const Animals& now, const Animals& before) {
  std::vector<std::uint32_t> slots;
  now.for_each_difference(before, [&](std::uint32_t first, std::uint32_t end) {
    EXPECT_TRUE(slots.empty() || first > slots.back());
    for (std::uint32_t slot = first; slot < end; ++slot) slots.push_back(slot);
  });
  return slots;
}

TEST(Table, DifferencesFromASnapshotAreVisitedAndLittleElse) {
  Animals animals;
  std::vector<AnimalId> ids;
  for (int i = 0; i < 20000; ++i) ids.push_back(animals.insert(std::to_string(i)));
  const Animals before = animals.snapshot();
  EXPECT_TRUE(visited(animals, before).empty());
  animals.edit(ids[5]) = "five";
  animals.erase(ids[9000]);
  const AnimalId late = animals.insert("late");  // takes slot 9000
  for (int i = 0; i < 5000; ++i) animals.insert("more");
  const std::vector<std::uint32_t> slots = visited(animals, before);
  for (const std::uint32_t slot : {5U, 9000U, 20000U, 24999U}) {
    EXPECT_TRUE(std::binary_search(slots.begin(), slots.end(), slot)) << slot;
  }
  EXPECT_LE(slots.size(), 5000U + 4U * 64U);
  EXPECT_EQ(late.slot, 9000U);
  EXPECT_EQ(visited(before, animals), slots);
  const Animals after = animals.snapshot();
  EXPECT_TRUE(visited(animals, after).empty());
  EXPECT_EQ(visited(after, before), slots);
}

TEST(Table, ValuesOfSomeSlotsInOrder) {
  Animals animals;
  std::vector<AnimalId> ids;
  for (int i = 0; i < 200; ++i) ids.push_back(animals.insert(std::to_string(i)));
  animals.erase(ids[130]);
  std::vector<std::string> seen;
  animals.for_each_in(128, 192, [&](AnimalId id, const std::string& value) {
    EXPECT_EQ(value, std::to_string(id.slot));
    seen.push_back(value);
  });
  EXPECT_EQ(seen.size(), 63U);
  animals.for_each_in(192, 256, [&](AnimalId, const std::string& value) { seen.push_back(value); });
  EXPECT_EQ(seen.size(), 63U + 8U);
}

TEST(Table, ManySnapshotsOfManyBranchesStayAsTheyWere) {
  std::mt19937 random(7);
  Animals animals;
  std::map<AnimalId, std::string> model;
  std::vector<std::pair<Animals, std::map<AnimalId, std::string>>> kept;
  for (int round = 0; round < 12; ++round) {
    for (int i = 0; i < 1500; ++i) {
      const std::string value = std::to_string(random());
      if (model.empty() || random() % 3 != 0) {
        model[animals.insert(value)] = value;
      } else {
        const auto at = std::next(model.begin(), random() % model.size());
        if (random() % 2 == 0) {
          animals.edit(at->first) = value;
          at->second = value;
        } else {
          animals.erase(at->first);
          model.erase(at);
        }
      }
    }
    kept.emplace_back(animals.snapshot(), model);
  }
  EXPECT_GT(animals.slots(), 4096U);
  for (const auto& [table, expected] : kept) {
    std::map<AnimalId, std::string> found;
    table.for_each([&](AnimalId id, const std::string& value) { found[id] = value; });
    EXPECT_EQ(found, expected);
  }
}

TEST(Table, APartHasItsValuesUnderTheirIdsAndNothingElse) {
  const std::vector<std::pair<AnimalId, std::string>> values = {
      {{3, 2}, "cat"}, {{9000, 1}, "dog"}, {{9001, 5}, "cow"}};
  auto part = Animals::of_part(values, 20'000);
  ASSERT_TRUE(part);
  EXPECT_EQ(part->size(), 3U);
  EXPECT_EQ(part->slots(), 20'000U);
  for (const auto& [id, value] : values) EXPECT_EQ(part->at(id), value);
  EXPECT_FALSE(part->find({3, 1}));
  EXPECT_FALSE(part->find({4, 1}));
  EXPECT_FALSE(part->find({15'000, 1}));
  EXPECT_EQ(part->ids(), (std::vector<AnimalId>{{3, 2}, {9000, 1}, {9001, 5}}));
  int seen = 0;
  part->for_each_in(8'990, 9'001, [&](AnimalId, const std::string&) { ++seen; });
  EXPECT_EQ(seen, 1);
  const Animals before = part->snapshot();
  part->edit({3, 2}) = "lynx";
  EXPECT_EQ(before.at({3, 2}), "cat");
  EXPECT_EQ(part->at({3, 2}), "lynx");
  EXPECT_FALSE(Animals::of_part({{{3, 1}, "a"}, {{3, 1}, "b"}}, 10)) << "twice";
  EXPECT_FALSE(Animals::of_part({{{10, 1}, "a"}}, 10)) << "beyond the last";
  EXPECT_FALSE(Animals::of_part({{{1, 0}, "a"}}, 10)) << "no id";
}

TEST(Table, EditsOfAForkAreTakenOverWhereNothingHasChangedMeanwhile) {
  Animals animals;
  std::vector<AnimalId> ids;
  for (int i = 0; i < 20'000; ++i) ids.push_back(animals.insert(std::to_string(i)));
  const Animals before = animals.snapshot();
  Animals fork = before.fork();
  for (const AnimalId id : ids) {
    if (id.slot % 2 == 0) fork.edit(id) += " moved";
  }
  EXPECT_EQ(before.at(ids[0]), "0") << "a snapshot stays as it is";
  animals.edit(ids[100]) = "newer";
  animals.edit(ids[101]) = "newer";
  animals.erase(ids[200]);
  const AnimalId reused = animals.insert("new");
  const AnimalId added = animals.insert("added");
  EXPECT_EQ(reused.slot, 200U);
  std::vector<AnimalId> newer;
  animals.adopt(before, fork, [&](AnimalId id) { newer.push_back(id); });
  EXPECT_EQ(newer, (std::vector<AnimalId>{ids[100], ids[101], reused, added}));
  for (const AnimalId id : ids) {
    if (id == ids[200]) continue;
    const std::string plain = std::to_string(id.slot);
    const bool is_newer = id == ids[100] || id == ids[101];
    ASSERT_EQ(animals.at(id), is_newer ? "newer" : id.slot % 2 == 0 ? plain + " moved" : plain);
  }
  EXPECT_EQ(animals.size(), 20'001U);
  // What was taken over belongs to the fork as well: it is cloned before it is edited.
  animals.edit(ids[0]) = "again";
  EXPECT_EQ(fork.at(ids[0]), "0 moved");
  animals.erase(ids[2]);
  EXPECT_EQ(fork.at(ids[2]), "2 moved");
  EXPECT_EQ(animals.insert("in its place").slot, 2U);
}

}  // namespace
}  // namespace ydd
