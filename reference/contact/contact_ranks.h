// A contact problem on several ranks: what goes between the first rank and the others.
#pragma once

namespace touchstone::reference {

/// The life of every rank but the first, until the first one's session ends.
void follow_first_rank();

}  // namespace touchstone::reference
