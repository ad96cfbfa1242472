// Status words by their index in /api/series, and their meaning (docs/file-formats.md, displacement.csv).
export const statuses = [
  { word: 'ok', meaning: 'reliable' },
  { word: 'untrusted', meaning: 'the frame contradicts the model by far more than the noise' },
  { word: 'camera-moved', meaning: 'the references moved, so the camera moved' },
  { word: 'blurred', meaning: 'motion blur or defocus' },
  { word: 'saturated', meaning: 'grey levels at the end of the range' },
  { word: 'partly-covered', meaning: 'an object occludes part of the marker' },
  { word: 'lost', meaning: 'the target was not found' },
  { word: 'reference-lost', meaning: 'too few references were found, or the frame comes before the reference frame' },
  { word: 'order-unproven', meaning: 'the number of whole pitches could not be determined' },
  { word: 'decode-error', meaning: 'the frame is damaged' },
  { word: 'too-coarse', meaning: 'the pitch in the image is too small' },
];

export const statusIndex = (word: string): number => Math.max(0, statuses.findIndex((status) => status.word === word));
