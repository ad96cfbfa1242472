// Lists the folder.
const token = document.querySelector('meta[name="moiregauge-token"]').content || new URLSearchParams(location.hash.slice(1)).get('token') || '';
fetch('/api/entries', { headers: { 'X-Moiregauge-Token': token } }).then((answer) => answer.json()).then(({ entries }) => {
  for (const entry of entries) {
    const item = document.createElement('li');
    item.textContent = `${entry.path} (${entry.state})`;
    document.getElementById('entries').append(item);
  }
});
