export function App() {
  return <main>conav console</main>;
}
