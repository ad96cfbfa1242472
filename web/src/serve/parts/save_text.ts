// Saves text as a file.
import { save } from '../../download';

export const saveText = (name: string, text: string): void => save(name, new Blob([text], { type: 'text/csv' }));
