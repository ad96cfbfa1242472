// The first page on paper: headline, table and the first plots. Texts that have no room there follow on the next page.

const kPage_mm = 269; // A4 without its margins (page.css)
const kHead_mm = 33; // name, badge, heading of the result
const kPlots_mm = { one: 111, many: 98 }; // heading of the displacement and its first two plots, of one or many targets
const kWarnings_mm = 14; // their heading and margins
const kTable_mm = 16; // its caption and head
const kRow_mm = 5.2;
const kText_mm = 4.7; // one line of text
const kGap_mm = 1.1; // after an item
const kMore_mm = 5; // the line that counts what follows later
const kKeys_mm = 9.4; // a second line of keys in both plots
const kManyKeys = 5;
const kLetters = 96; // in one line of text, at least

export interface FirstPage {
  warnings: number;
  sentences: number;
  targets: number;
}

const height = (texts: string[]): number => texts.reduce((sum, text) => sum + kGap_mm + kText_mm * Math.ceil(text.length / kLetters), 0);

// Returns how many warnings, sentences and targets of the table the first page holds. At least one of each is shown.
export function firstPage(warnings: string[], sentences: string[], targets: number): FirstPage {
  const n: FirstPage = { warnings: warnings.length, sentences: sentences.length, targets };
  const whole = { ...n };
  const more = (): number => kMore_mm * (['warnings', 'sentences', 'targets'] as const).filter((key) => n[key] < whole[key]).length;
  const plots = (targets > 1 ? kPlots_mm.many : kPlots_mm.one) + (targets > kManyKeys ? kKeys_mm : 0);
  const used = (): number => kHead_mm + plots + more() + (n.warnings > 0 ? kWarnings_mm : 0) + height(warnings.slice(0, n.warnings)) +
    height(sentences.slice(0, n.sentences)) + kTable_mm + 2 * kRow_mm * n.targets;
  while (used() > kPage_mm) {
    // The part that takes most room gives way, down to one item.
    const room: [keyof FirstPage, number][] = [['warnings', height(warnings.slice(0, n.warnings))],
      ['sentences', height(sentences.slice(0, n.sentences))], ['targets', 2 * kRow_mm * n.targets]];
    const largest = room.filter(([key]) => n[key] > 1).sort((a, b) => b[1] - a[1])[0];
    if (!largest) break;
    --n[largest[0]];
  }
  return n;
}
