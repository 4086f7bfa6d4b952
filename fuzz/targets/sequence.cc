// SPDX-License-Identifier: Apache-2.0
#include "support.h"
#include "targets.h"
#include "ydd/sources/source.h"

namespace ydd::fuzz {

// rgb.txt, depth.txt and a list of pairs, with a zero byte between; without the last, by time.
void sequence(std::string_view input) {
  static const Folder folder;
  Pieces pieces(input);
  folder.write("rgb.txt", pieces.until('\0'));
  folder.write("depth.txt", pieces.until('\0'));
  SequenceOptions options;
  if (!pieces.done()) {
    options.associations = folder.write("associations.txt", pieces.text(input.size()));
  }
  const Result<Sequence> sequence = open_sequence(folder.path(), options);
  expect_one_line(sequence);
  if (!sequence) return;
  for (std::size_t i = 1; i < sequence->size(); ++i) {
    if (!(sequence->entry(i - 1).stamp < sequence->entry(i).stamp)) broken("not by time");
  }
}

}  // namespace ydd::fuzz
