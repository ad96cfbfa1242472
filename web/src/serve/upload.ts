// Uploads: files and folders that are dropped or chosen go to the server in pieces. A broken upload resumes where it stopped.
import { get, query, Refusal, request } from './api';
import { button, sayProblem, sizeText } from './parts/parts';
import { refreshEntries, session } from './store';
import { el } from '../element';

const kPiece = 8 << 20; // bytes in one request
const kAttempts = 5; // per piece
const kPause_ms = 700; // before the next attempt
const kNameInUse = 409;
const kFinal = [400, kNameInUse, 413, 422]; // refusals that another attempt cannot change
const kMaxNumber = 20; // added to a name in use

interface Upload {
  name: string;
  file: File;
  element: HTMLElement;
  bar: HTMLProgressElement;
  text: HTMLElement;
  abort: AbortController;
}

// Returns the files of a drop, with their folders' names in front.
async function filesOf(items: DataTransferItemList): Promise<{ name: string; file: File }[]> {
  const found: { name: string; file: File }[] = [];
  const walk = async (entry: FileSystemEntry): Promise<void> => {
    if (entry.isFile) {
      const file = await new Promise<File>((done, failed) => (entry as FileSystemFileEntry).file(done, failed));
      found.push({ name: entry.fullPath.replace(/^\//, ''), file });
      return;
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) { // a reader gives at most 100 entries at once
      const part = await new Promise<FileSystemEntry[]>((done, failed) => reader.readEntries(done, failed));
      if (part.length === 0) return;
      for (const one of part) await walk(one);
    }
  };
  const roots = [...items].map((item) => item.webkitGetAsEntry()).filter((entry): entry is FileSystemEntry => entry !== null);
  for (const root of roots) await walk(root);
  return found;
}

export class Uploads {
  readonly element: HTMLElement;
  private readonly list = el('ul', { class: 'uploads', 'aria-label': 'Uploads' });
  private readonly chooser = el('input', { type: 'file', multiple: '', hidden: '', 'aria-label': 'Files to upload' });
  private queue = Promise.resolve();

  // `onStored` gets the names of one drop when the last of its files is stored.
  constructor(private readonly onStored: (names: string[]) => void) {
    this.chooser.addEventListener('change', () => {
      this.add([...(this.chooser.files ?? [])].map((file) => ({ name: file.name, file })));
      this.chooser.value = '';
    });
    const drop = el('div', { class: 'drop' }, el('strong', {}, 'Drop clips here'), el('span', {}, 'or image folders, or a sensor\u2019s CSV'),
      button('Choose files', () => this.chooser.click(), { class: 'small' }), this.chooser);
    this.element = el('div', {}, drop, this.list);
    this.acceptDrops();
  }

  private acceptDrops(): void {
    let depth = 0; // nested elements that the pointer has entered
    const mark = (): void => void document.documentElement.classList.toggle('dropping', depth > 0);
    const hasFiles = (event: DragEvent): boolean => event.dataTransfer?.types.includes('Files') ?? false;
    addEventListener('dragenter', (event) => {
      if (!hasFiles(event)) return;
      ++depth;
      mark();
    });
    addEventListener('dragleave', (event) => {
      if (!hasFiles(event)) return;
      depth = Math.max(0, depth - 1);
      mark();
    });
    addEventListener('dragover', (event) => {
      if (hasFiles(event)) event.preventDefault();
    });
    addEventListener('drop', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      depth = 0;
      mark();
      void filesOf(event.dataTransfer!.items).then((files) => this.add(files)).catch(sayProblem);
    });
  }

  add(files: { name: string; file: File }[]): void {
    const limit = session.limits.upload_bytes;
    const accepted = files.filter(({ name, file }) => {
      if (limit > 0 && file.size > limit) sayProblem(new Error(`${name} is larger than the server accepts (${sizeText(limit)}). Copy it into the folder.`));
      return !(limit > 0 && file.size > limit) && file.size > 0;
    });
    const stored: string[] = [];
    accepted.forEach(({ name, file }, k) => {
      const upload = this.row(name, file);
      this.queue = this.queue.then(async () => {
        if (await this.send(upload)) stored.push(name);
        if (k < accepted.length - 1) return;
        await refreshEntries().catch(() => undefined);
        if (stored.length > 0) this.onStored(stored);
      });
    });
  }

  private row(name: string, file: File): Upload {
    const bar = el('progress', { max: '1', value: '0', 'aria-label': `Upload of ${name}` });
    const text = el('span', { class: 'quiet' }, 'waits');
    const abort = new AbortController();
    const element = el('li', {}, el('span', { class: 'name' }, name), text, bar);
    element.append(button('\u00d7', () => {
      abort.abort();
      element.remove();
    }, { class: 'quiet', 'aria-label': `Cancel the upload of ${name}` }));
    this.list.append(element);
    return { name, file, element, bar, text, abort };
  }

  // Returns true if the whole file is stored.
  private async send({ name, file, element, bar, text, abort }: Upload): Promise<boolean> {
    const { signal } = abort;
    try {
      let at = (await get<{ received: number }>(query('/api/upload', { name, size: file.size }), { signal })).received;
      if (at > file.size) at = 0;
      for (let attempts = 0; at < file.size;) {
        bar.value = at / file.size;
        text.textContent = `${sizeText(at)} of ${sizeText(file.size)}`;
        try {
          const answer = await request(query('/api/upload', { name, offset: at, size: file.size }),
            { method: 'POST', body: file.slice(at, at + kPiece), headers: { 'Content-Type': 'application/octet-stream' }, signal });
          at = ((await answer.json()) as { received: number }).received;
          attempts = 0;
        } catch (problem) {
          if (signal.aborted || ++attempts >= kAttempts) throw problem;
          await new Promise((done) => setTimeout(done, kPause_ms * attempts));
          at = (await get<{ received: number }>(query('/api/upload', { name, size: file.size }), { signal })).received;
        }
      }
      element.remove();
      return true;
    } catch (problem) {
      if (signal.aborted) return false;
      sayProblem(problem);
      if (problem instanceof Refusal && kFinal.includes(problem.status)) {
        text.textContent = 'refused';
        return false;
      }
      text.textContent = 'stopped';
      const again = button('Resume', () => {
        again.remove();
        this.queue = this.queue.then(async () => {
          if (await this.send({ name, file, element, bar, text, abort })) this.onStored([name]);
        });
      }, { class: 'small' });
      element.append(again);
      return false;
    }
  }
}

// Writes one file to the server without a row, e.g. the record of another sensor.
// A name in use gets a number.
export async function sendFile(file: File, number = 1): Promise<string> {
  const name = number === 1 ? file.name : file.name.replace(/(\.[^.]*)?$/, `-${number}$1`);
  try {
    for (let at = 0; at < file.size;) {
      const answer = await request(query('/api/upload', { name, offset: at, size: file.size }),
        { method: 'POST', body: file.slice(at, at + kPiece), headers: { 'Content-Type': 'application/octet-stream' } });
      at = ((await answer.json()) as { received: number }).received;
    }
  } catch (problem) {
    if (problem instanceof Refusal && problem.status === kNameInUse && number < kMaxNumber) return sendFile(file, number + 1);
    throw problem;
  }
  return name;
}

